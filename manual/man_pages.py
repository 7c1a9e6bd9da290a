# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The manual pages of section 1, in troff's man macros."""
import re

EXIT_STATUS = """\
.SH EXIT STATUS
0 where all was done; 1 after an error, of which one line on standard error \
tells what is wrong and what to do.
"""


def troff(text):
    """A text as troff prints it: with backslashes, hyphens that are to be
    copied, and letters at the start of a line that would be commands to it."""
    text = text.replace("\\", "\\e")
    text = re.sub(r"^(?=[.'])", r"\\&", text, flags=re.MULTILINE)
    return text.replace("-", "\\-").replace("'", "\\(aq")


def bold(text):
    return f"\\fB{troff(text)}\\fR"


def italic(text):
    return f"\\fI{troff(text)}\\fR"


def page_name(program, command):
    return f"{program['name']}-{command['name']}"


def head(program, page, title):
    """No date: the same sources give the same pages. Words stay whole, and lines
    ragged, since names are long."""
    return (
        f'.TH {troff(page.upper())} 1 "" "TSAR for COLMAP {program["version"]}" "TSAR for COLMAP"\n'
        f".nh\n.ad l\n.SH NAME\n{troff(page)} \\- {troff(title)}\n"
    )


def option_words(option):
    return f"{bold('--' + option['name'])} {italic(option['value'])}"


def synopsis(program, command):
    lines = []
    for form in command["forms"]:
        words = " ".join(filter(None, (program["name"], command["name"], form["name"])))
        required = [option_words(option) for option in form["options"] if option["required"]]
        lines.append(" ".join([bold(words), *required, f"[{italic('options')}]\n"]))
    return ".SH SYNOPSIS\n" + ".br\n".join(lines)


def help_options(what):
    """How the help and its JSON are had; what: what they tell."""
    return (
        f".TP\n{bold('-h')}, {bold('--help')}, {bold('--help_all')}\nPrint {what}.\n"
        f".TP\n{bold('--help_json')}\nPrint {what} as JSON, for programs.\n"
    )


def option_text(option):
    remark = ""
    if option["required"]:
        remark = " (required)"
    elif option["default"]:
        remark = f" (default: {troff(option['default'])})"
    return f".TP\n{option_words(option)}{remark}\n{troff(option['description'])}\n"


def options(command, form):
    title = ".SH OPTIONS"
    if form["name"]:
        title += f" OF {troff(command['name'])} {troff(form['name'])}\n{troff(form['summary'])}"
    return f"{title}\n" + "".join(map(option_text, form["options"])) + help_options("these options")


def see_also(program, pages):
    lines = [f".BR {troff(page)} (1),\n" for page in pages]
    return ".SH SEE ALSO\n" + "".join(lines) + ".BR colmap (1)\n"


def program_page(program):
    """The page of the program, which lists the commands."""
    commands = program["commands"]
    entries = [
        f".TP\n{bold(command['name'])}\n{troff(command['title'])}. See\n"
        f".BR {troff(page_name(program, command))} (1).\n"
        for command in commands
    ]
    return (
        head(program, program["name"], "complete the depth maps of COLMAP")
        + f".SH SYNOPSIS\n{bold(program['name'])} {italic('COMMAND')} [{italic('options')}]\n"
        + f".SH DESCRIPTION\n{troff(program['summary'])}\n.SH COMMANDS\n"
        + "".join(entries)
        + ".SH OPTIONS\n"
        + help_options("the list of commands")
        + f".TP\n{bold('--version')}\nPrint the version and whether the GPU part was built.\n"
        + EXIT_STATUS
        + see_also(program, [page_name(program, command) for command in commands])
    )


def command_page(program, command):
    """The page of one command with all its options."""
    forms = command["forms"]
    examples = [f"{troff(program['name'])} {troff(form['example'])}\n" for form in forms]
    others = [page_name(program, other) for other in program["commands"] if other is not command]
    return (
        head(program, page_name(program, command), command["title"])
        + synopsis(program, command)
        + f".SH DESCRIPTION\n{troff(command['summary'])}\n"
        + "".join(options(command, form) for form in forms)
        + EXIT_STATUS
        + ".SH EXAMPLES\n.nf\n"
        + "".join(examples)
        + ".fi\n"
        + see_also(program, [program["name"], *others])
    )
