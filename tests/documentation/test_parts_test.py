#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The list of the tests' large parts names what exists, and scripts/test.sh can
run each of them; the changed files decide which."""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from sample_testing import check, parse_arguments

args = parse_arguments("repository")
repository = Path(args.repository)
sys.path.insert(0, str(repository / "scripts"))
sys.dont_write_bytecode = True
from test_parts import changed_files, choose, exclusion  # noqa: E402

parts = json.loads((repository / "tests" / "parts.json").read_text())
lists = "".join(path.read_text()
                for path in (repository / "tests").glob("*/CMakeLists.txt"))
script = (repository / "scripts" / "test.sh").read_text()
for name, part in parts.items():
    gone = [path for path in part["paths"] if not (repository / path).exists()]
    check(part["paths"] and not gone, f"{name} depends on what is there {gone}")
    unknown = [test for test in part["tests"]
               if not re.search(rf"[\s(]{re.escape(test)}\s", lists)]
    check(not unknown, f"{name} has tests that are registered {unknown}")
    check(part["tests"] or f"includes {name};" in script,
          f"{name} has tests, or scripts/test.sh asks for it")
asked = set(re.findall(r"includes\w* (\w+);", script))
check(asked <= set(parts), f"scripts/test.sh asks for parts of the list: {asked}")

drawn = {"page": {"paths": ["report", "tests/page"], "tests": ["Page.Works"]},
         "wheel": {"paths": ["python/wheel.py"], "tests": ["Wheel.1", "Wheel.2"]}}
for changed, expected in ((["report/page.cc"], ["page"]), (["report"], ["page"]),
                          (["reports/page.cc", "README.md"], []),
                          (["python/wheel.py", "tests/page/a.py"], ["page", "wheel"]),
                          ([], []), (None, ["page", "wheel"])):
    check(choose(drawn, changed) == expected, f"{changed} affects {expected}")
for chosen, left_out in (([], ["Page.Works", "Wheel.1", "Wheel.2"]),
                         (["page"], ["Wheel.1", "Wheel.2"]), (["page", "wheel"], [])):
    pattern = re.compile(exclusion(drawn, chosen))
    found = [test for test in ("Page.Works", "Wheel.1", "Wheel.2", "Wheel.10", "PageXWorks")
             if pattern.search(test)]
    check(found == left_out, f"with {chosen}, {left_out} are left out")

with tempfile.TemporaryDirectory() as folder:
    def git(*arguments, date="2026-01-01T00:00:00Z"):
        subprocess.run(
            ["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b", *arguments],
            check=True, stdout=subprocess.DEVNULL,
            env={"PATH": "/usr/bin:/bin", "HOME": folder,
                 "GIT_AUTHOR_DATE": date, "GIT_COMMITTER_DATE": date})

    def commit(name, day):
        (Path(folder) / name).write_text(day)
        git("add", "-A")
        git("commit", "-q", "-m", name, date=f"2026-01-{day}T12:00:00Z")

    check(changed_files(folder) is None, "without a history everything may have changed")
    git("init", "-q")
    commit("first", "01")
    check(changed_files(folder) is None, "so it may where the history is of one day")
    commit("second", "05")
    commit("third file", "06")
    check(changed_files(folder) == ["third file"], "what changed within a day")
    (Path(folder) / "fourth").write_text("")
    (Path(folder) / "first").write_text("edited")
    check(sorted(changed_files(folder)) == ["first", "fourth", "third file"],
          "what is not committed changed, too")
    check(sorted(changed_files(folder, "HEAD~1")) == ["first", "fourth", "third file"] and
          sorted(changed_files(folder, "HEAD")) == ["first", "fourth"],
          "what changed since a commit that is named")
    check(changed_files(folder, "nothing") is None, "a commit that is not there")
