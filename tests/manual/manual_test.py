#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the manual pages and the completions with --help_json: every
command, option, choice and default is in them, the pages are clean troff, and
bash really completes. What needs a shell or formatter that is not installed is
skipped, and a line says so."""
import gzip
import json
import os
import re
import shutil

from sample_testing import call, check, parse_arguments, run

args = parse_arguments("program", "pages", "folder")


def told(*words):
    return json.loads(run(args.program, *words, "--help_json"))


def has(tool):
    if not shutil.which(tool):
        print(f"skipped: {tool} is not installed")
    return shutil.which(tool)


COMMANDS = [command["name"] for command in told()["commands"]]
# The options of each way to call a command: some need a word more.
CALLS = {}
for command in COMMANDS:
    description = told(command)
    for form in description.get("forms", [{}]):
        words = (command, *form.values())[:2]
        CALLS[words] = (told(*words) if form else description)["options"]
PAGES = ["colmap_tsar"] + ["colmap_tsar-" + command for command in COMMANDS]


def plain(troff):
    """The letters of a line of troff without its fonts and escapes."""
    text = re.sub(r"\\f[BIR]", "", troff)
    return text.replace("\\-", "-").replace("\\(aq", "'").replace("\\&", "").replace("\\e", "\\")


def page(name):
    with gzip.open(os.path.join(args.pages, "man1", name + ".1.gz"), "rt") as file:
        return file.read()


def test_pages():
    files = sorted(os.listdir(os.path.join(args.pages, "man1")))
    check(files == sorted(name + ".1.gz" for name in PAGES), "a page for each command")
    overview = plain(page(PAGES[0]))
    check(all(f"{name} (1)" in overview for name in PAGES[1:]), "the overview names all")
    for words, options in CALLS.items():
        lines = plain(page("colmap_tsar-" + words[0])).splitlines()
        if len(words) > 1:
            lines = lines[lines.index(f".SH OPTIONS OF {' '.join(words)}"):]
        missing = []
        for option in options:
            default = f"(default: {option['default']})" if option["default"] else ""
            remark = "(required)" if option["required"] else default
            head = " ".join(f"--{option['name']} {option['value']} {remark}".split())
            if head not in lines or lines[lines.index(head) + 1] != option["description"]:
                missing.append(head)
        check(not missing, f"{' '.join(words)}: page has every option: {missing}")


def test_troff():
    """No warnings of the formatter, whichever is there."""
    for name in PAGES if has("groff") else ():
        source = os.path.join(args.folder, name + ".1")
        with open(source, "w") as file:
            file.write(page(name))
        result = call("groff", "-ww", "-z", "-man", "-Tutf8", source)
        check(result.returncode == 0 and not result.stderr, f"groff -ww {name}: {result.stderr}")


def bash_completes(*words):
    """What bash offers for the last of these words."""
    script = (
        'source "$1"; shift; complete -p colmap_tsar >/dev/null || exit 1\n'
        'COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _colmap_tsar\n'
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    path = os.path.join(args.pages, "bash")
    text = run("bash", "-c", script, "bash", path, "colmap_tsar", *words)
    return [line for line in text.split("\n") if line]


def values_of(option):
    """What a shell offers after an option."""
    if option["choices"]:
        return option["choices"]
    return [os.path.join(args.folder, "a b folder")] if option["is_path"] else []


def test_bash():
    check(set(bash_completes("")) >= set(COMMANDS) | {"--help", "--version"}, "bash: all commands")
    check(bash_completes("tsar_ref") == ["tsar_refine"], "bash: one command")
    check(bash_completes("nothing", "--") == [], "bash: an unknown command")
    check(bash_completes("tsar_evaluate", "d") == ["depth"], "bash: a form")
    for words, options in CALLS.items():
        names = ["--" + option["name"] for option in options]
        found = bash_completes(*words, "--")
        check(set(found) == {*names, "--help", "--help_all", "--help_json"},
              f"bash: the options of {' '.join(words)}")
        start = os.path.join(args.folder, "a b")
        wrong = [
            option["name"] for option in options
            for behind in ([""], ["=", ""], ["="])
            if bash_completes(*words, "--" + option["name"],
                              *([start] if option["is_path"] else behind)) != values_of(option)
        ]
        check(not wrong, f"bash: what follows the options of {' '.join(words)}: {wrong}")


def test_fish_and_zsh():
    """Checks that the files for fish and zsh name all commands and options."""
    for shell, command, written, choices in (("fish", " -a {} ", " -l {} ", " -a '{}' "),
                                             ("zsh", "'{}':", "--{}=", "({})")):
        path = os.path.join(args.pages, shell)
        with open(path) as file:
            text = file.read()
        missing = [name for name in COMMANDS if command.format(name) not in text]
        check(not missing, f"{shell}: all commands: {missing}")
        for words, options in CALLS.items():
            wrong = [option["name"] for option in options
                     if written.format(option["name"]) not in text or
                     (option["choices"] and choices.format(" ".join(option["choices"])) not in text)]
            check(not wrong, f"{shell}: the options of {' '.join(words)}: {wrong}")
        if has(shell):
            run(shell, "-n", path)


shutil.rmtree(args.folder, ignore_errors=True)
os.makedirs(os.path.join(args.folder, "a b folder"))
check(len(COMMANDS) > 3 and len(CALLS) > len(COMMANDS), "--help_json lists commands")
test_pages()
test_troff()
test_bash()
test_fish_and_zsh()
