#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the manual pages and the completions with --help: every command,
option, choice and default is in them, the pages are clean troff, and bash and
fish really complete. What needs a shell or formatter that is not installed is
skipped by a line that says so."""
import argparse
import functools
import gzip
import os
import re
import shutil

from sample_testing import call, check, run

parser = argparse.ArgumentParser()
for name in ("program", "pages", "folder"):
    parser.add_argument("--" + name, required=True)
args = parser.parse_args()
ANY_VALUE = ("PATH", "TEXT", "INT", "NUMBER", "NAME=VALUE,...", "")
OPTION = re.compile(r"^  (?:-h, )?--(\S+)(?: (\S+))?( \(.*\))?$")


@functools.lru_cache(None)
def commands():
    """The commands that --help lists."""
    text = run(args.program, "--help")
    return re.findall(r"^  (tsar_\w+) ", text, re.MULTILINE)


@functools.lru_cache(None)
def calls():
    """Each way to call a command, as words: some need a word more."""
    found = []
    for command in commands():
        text = run(args.program, command, "--help")
        forms = re.findall(rf"^  {command} (\w+) \[options\]", text, re.MULTILINE)
        found += [(command, form) for form in forms] or [(command,)]
    return found


@functools.lru_cache(None)
def options(words):
    """What --help tells: name -> (value, remark, description)."""
    found = {}
    name = None
    for line in run(args.program, *words, "--help").splitlines():
        match = OPTION.match(line)
        if match:
            name = match[1]
            found[name] = (match[2] or "", (match[3] or "").strip(), [])
        elif name:
            found[name][2].append(line.strip())
    return {
        name: (value, remark, " ".join(" ".join(lines).split()))
        for name, (value, remark, lines) in found.items()
    }


def plain(troff):
    """The letters of a line of troff without its fonts and escapes."""
    text = re.sub(r"\\f[BIR]", "", troff)
    return text.replace("\\-", "-").replace("\\(aq", "'").replace("\\&", "").replace("\\e", "\\")


def page(name):
    with gzip.open(os.path.join(args.pages, "man1", name + ".1.gz"), "rt") as file:
        return file.read()


def test_pages():
    names = ["colmap_tsar"] + ["colmap_tsar-" + command for command in commands()]
    check(
        sorted(os.listdir(os.path.join(args.pages, "man1")))
        == sorted(name + ".1.gz" for name in names),
        "there is a page for the program and for each command",
    )
    overview = plain(page("colmap_tsar"))
    for command in commands():
        check(f"colmap_tsar-{command} (1)" in overview, f"the overview names {command}")
    for words in calls():
        lines = plain(page("colmap_tsar-" + words[0])).splitlines()
        if len(words) > 1:
            lines = lines[lines.index(f".SH OPTIONS OF {' '.join(words)}"):]
            ends = [i for i, line in enumerate(lines) if i > 0 and line.startswith(".SH")]
            lines = lines[: ends[0]]
        for name, (value, remark, text) in options(words).items():
            if name in ("help", "help_json"):
                check(any("--" + name in line for line in lines), f"{words}: page has --{name}")
                continue
            head = " ".join(f"--{name} {value} {remark}".split())
            check(
                head in lines and lines[lines.index(head) + 1] == text,
                f"{' '.join(words)}: page has --{name} as --help does",
            )


def test_troff():
    """No warnings of the formatter, whichever is there."""
    for name in sorted(os.listdir(os.path.join(args.pages, "man1"))):
        path = os.path.join(args.pages, "man1", name)
        if shutil.which("groff"):
            source = os.path.join(args.folder, name[: -len(".gz")])
            with open(source, "w") as file:
                file.write(page(name[: -len(".1.gz")]))
            result = call("groff", "-ww", "-z", "-man", "-Tutf8", source)
            check(result.returncode == 0 and not result.stderr, f"groff -ww {name}: {result.stderr}")
        if shutil.which("man"):
            result = call("man", "--warnings", "-E", "UTF-8", "-l", path)
            check(
                result.returncode == 0 and not result.stderr and "SEE ALSO" in result.stdout,
                f"man --warnings {name}: {result.stderr}",
            )
    for tool in ("groff", "man"):
        if not shutil.which(tool):
            print(f"skipped: {tool} is not installed")


def bash_completes(*words):
    """What bash offers for the last of these words."""
    script = (
        'source "$1"; shift; complete -p colmap_tsar >/dev/null || exit 1\n'
        'COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _colmap_tsar\n'
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    text = run("bash", "-c", script, "bash", os.path.join(args.pages, "bash"), *words)
    return [line for line in text.split("\n") if line]


def test_bash():
    check(
        set(bash_completes("colmap_tsar", "")) >= set(commands()) | {"--help", "--version"},
        "bash: all commands",
    )
    check(bash_completes("colmap_tsar", "tsar_ref") == ["tsar_refine"], "bash: one command")
    check(bash_completes("colmap_tsar", "nothing", "--") == [], "bash: an unknown command")
    for words in calls():
        line = ["colmap_tsar", *words]
        known = options(words)
        check(
            sorted(bash_completes(*line, "--")) == sorted("--" + name for name in known),
            f"bash: the options of {' '.join(words)}",
        )
        for name, (value, _, _) in known.items():
            if value not in ANY_VALUE:
                check(
                    bash_completes(*line, "--" + name, "") == value.split("|")
                    and bash_completes(*line, "--" + name, "=", "") == value.split("|")
                    and bash_completes(*line, "--" + name, "=") == value.split("|"),
                    f"bash: the choices of {' '.join(words)} --{name}",
                )
            elif value == "PATH":
                found = bash_completes(*line, "--" + name, os.path.join(args.folder, "a b"))
                check(
                    found == [os.path.join(args.folder, "a b folder")],
                    f"bash: files for {' '.join(words)} --{name}",
                )
            elif value:
                check(
                    bash_completes(*line, "--" + name, "") == [],
                    f"bash: nothing for {' '.join(words)} --{name}",
                )
    check(bash_completes("colmap_tsar", "tsar_evaluate", "d") == ["depth"], "bash: a form")


def test_fish():
    path = os.path.join(args.pages, "fish")
    if not shutil.which("fish"):
        print("skipped: fish is not installed")
        return
    run("fish", "--no-execute", path)

    def completes(line):
        text = run("fish", "--no-config", "-c", f"source {path}; complete -C '{line}'")
        return {found.split("\t")[0] for found in text.splitlines()}

    check(completes("colmap_tsar tsar_") == set(commands()), "fish: all commands")
    for words in calls():
        known = options(words)
        line = " ".join(["colmap_tsar", *words])
        check(
            completes(line + " --") == {"--" + name for name in known},
            f"fish: the options of {' '.join(words)}",
        )
        for name, (value, _, _) in known.items():
            if value not in ANY_VALUE:
                check(
                    completes(f"{line} --{name} ") == set(value.split("|")),
                    f"fish: the choices of {' '.join(words)} --{name}",
                )


def test_zsh():
    with open(os.path.join(args.pages, "zsh")) as file:
        text = file.read()
    check(text.startswith("#compdef colmap_tsar\n"), "zsh: the head that compinit looks for")
    for words in calls():
        for name, (value, _, _) in options(words).items():
            check(f"--{name}" in text, f"zsh: {' '.join(words)} --{name}")
            if value not in ANY_VALUE:
                check(f"({value.replace('|', ' ')})" in text, f"zsh: choices of --{name}")
    if shutil.which("zsh"):
        run("zsh", "-n", os.path.join(args.pages, "zsh"))
    else:
        print("skipped: zsh is not installed")


shutil.rmtree(args.folder, ignore_errors=True)
os.makedirs(os.path.join(args.folder, "a b folder"))
check(len(commands()) > 3 and len(calls()) > len(commands()), "--help lists commands")
test_pages()
test_troff()
test_bash()
test_fish()
test_zsh()
