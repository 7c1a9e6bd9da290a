#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the manual pages (compressed) and the shell completions of colmap_tsar,
from what the program tells of its commands and options by --help_json:

    write_manual.py PROGRAM FOLDER

    FOLDER/man1/*.1.gz, FOLDER/bash, FOLDER/zsh, FOLDER/fish
"""
import gzip
import json
import os
import subprocess
import sys

from completions import bash_completion, fish_completion, zsh_completion
from man_pages import command_page, program_page

NAME = "colmap_tsar"


def ask(program, *words):
    """What the program prints for these words and --help_json."""
    command = [program, *words, "--help_json"]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def describe_command(program, name, title):
    """One line of the program's help as "title", and the "forms", the ways to
    call the command: most commands have one, whose name is empty."""
    command = ask(program, name)
    names = [form["name"] for form in command.get("forms", [])]
    forms = [{**ask(program, name, form), "name": form} for form in names]
    return {
        "name": name,
        "title": title,
        "summary": command["summary"],
        "forms": forms or [{**command, "name": ""}],
    }


def describe_program(program):
    description = ask(program)
    commands = [
        describe_command(program, command["name"], command["summary"])
        for command in description["commands"]
    ]
    return {**description, "name": NAME, "commands": commands}


def write_text(path, text):
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(text)


def write_page(folder, name, text):
    """Without a date in the compressed file, so that it is the same every time."""
    with open(os.path.join(folder, "man1", name + ".1.gz"), "wb") as file:
        file.write(gzip.compress(text.encode(), compresslevel=9, mtime=0))


def main(program, folder):
    description = describe_program(program)
    os.makedirs(os.path.join(folder, "man1"), exist_ok=True)
    write_page(folder, NAME, program_page(description))
    for command in description["commands"]:
        write_page(folder, f"{NAME}-{command['name']}", command_page(description, command))
    write_text(os.path.join(folder, "bash"), bash_completion(description))
    write_text(os.path.join(folder, "zsh"), zsh_completion(description))
    write_text(os.path.join(folder, "fish"), fish_completion(description))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: write_manual.py PROGRAM FOLDER")
    main(*sys.argv[1:])
