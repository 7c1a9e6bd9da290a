// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "manual/man_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace tsar {
namespace {

std::string PageName(const ProgramDescription& program,
                     const CommandDescription& command) {
  return program.name + "-" + command.name;
}

// No date: the same sources give the same pages. Words stay whole, and lines
// ragged, since names are long.
std::string Head(const ProgramDescription& program,
                 const std::string& page,
                 const std::string& title) {
  std::string name = page;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::toupper(c));
  });
  std::ostringstream text;
  text << ".TH " << TroffText(name) << " 1 \"\" \"TSAR for COLMAP "
       << program.version << "\" \"TSAR for COLMAP\"\n"
       << ".nh\n.ad l\n.SH NAME\n"
       << TroffText(page) << " \\- " << TroffText(title) << "\n";
  return text.str();
}

std::string Bold(const std::string& text) {
  return std::string("\\fB").append(TroffText(text)).append("\\fR");
}

std::string Italic(const std::string& text) {
  return std::string("\\fI").append(TroffText(text)).append("\\fR");
}

std::string OptionWord(const OptionDescription& option) {
  return Bold("--" + option.name) + " " + Italic(option.value);
}

std::string Synopsis(const ProgramDescription& program,
                     const CommandDescription& command) {
  std::ostringstream text;
  text << ".SH SYNOPSIS\n";
  for (const FormDescription& form : command.forms) {
    std::string words = program.name + " " + command.name;
    if (!form.name.empty()) {
      words += " " + form.name;
    }
    text << (&form == &command.forms.front() ? "" : ".br\n") << Bold(words);
    for (const OptionDescription& option : form.options) {
      if (option.required) {
        text << " " << OptionWord(option);
      }
    }
    text << " [" << Italic("options") << "]\n";
  }
  return text.str();
}

// How the help and its JSON are had; what: what they tell.
std::string HelpOptions(const std::string& what) {
  std::ostringstream text;
  text << ".TP\n"
       << Bold("-h") << ", " << Bold("--help") << "\nPrint " << what
       << ".\n.TP\n"
       << Bold("--help_json") << "\nPrint " << what
       << " as JSON, for programs.\n";
  return text.str();
}

std::string Options(const CommandDescription& command,
                    const FormDescription& form) {
  std::ostringstream text;
  text << ".SH OPTIONS";
  if (!form.name.empty()) {
    text << " OF " << TroffText(command.name) << " " << TroffText(form.name)
         << "\n"
         << TroffText(form.summary);
  }
  text << "\n";
  for (const OptionDescription& option : form.options) {
    text << ".TP\n" << OptionWord(option);
    if (option.required) {
      text << " (required)";
    } else if (!option.default_value.empty()) {
      text << " (default: " << TroffText(option.default_value) << ")";
    }
    text << "\n" << TroffText(option.description) << "\n";
  }
  text << HelpOptions("these options");
  return text.str();
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n0 where all was done; 1 after an error, of which one "
    "line on standard error tells what is wrong and what to do.\n";

// All pages but the one itself, whose command's name is empty for the
// program's.
std::string SeeAlso(const ProgramDescription& program,
                    const std::string& itself) {
  std::ostringstream text;
  text << ".SH SEE ALSO\n";
  if (!itself.empty()) {
    text << ".BR " << TroffText(program.name) << " (1),\n";
  }
  for (const CommandDescription& command : program.commands) {
    if (command.name != itself) {
      text << ".BR " << TroffText(PageName(program, command)) << " (1),\n";
    }
  }
  text << ".BR colmap (1)\n";
  return text.str();
}

}  // namespace

std::string TroffText(const std::string& text) {
  std::string escaped;
  bool at_line_start = true;
  for (const char letter : text) {
    if (at_line_start && (letter == '.' || letter == '\'')) {
      escaped += "\\&";
    }
    at_line_start = letter == '\n';
    switch (letter) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

std::string ProgramManPage(const ProgramDescription& program) {
  std::ostringstream text;
  text << Head(program, program.name, "complete the depth maps of COLMAP")
       << ".SH SYNOPSIS\n"
       << Bold(program.name) << " " << Italic("COMMAND") << " ["
       << Italic("options") << "]\n.SH DESCRIPTION\n"
       << TroffText(program.summary) << "\n.SH COMMANDS\n";
  for (const CommandDescription& command : program.commands) {
    text << ".TP\n"
         << Bold(command.name) << "\n"
         << TroffText(command.title) << ". See\n.BR "
         << TroffText(PageName(program, command)) << " (1).\n";
  }
  text << ".SH OPTIONS\n"
       << HelpOptions("the list of commands") << ".TP\n"
       << Bold("--version")
       << "\nPrint the version and whether the GPU part was built.\n"
       << kExitStatus << SeeAlso(program, "");
  return text.str();
}

std::string CommandManPage(const ProgramDescription& program,
                           const CommandDescription& command) {
  std::ostringstream text;
  text << Head(program, PageName(program, command), command.title)
       << Synopsis(program, command) << ".SH DESCRIPTION\n"
       << TroffText(command.summary) << "\n";
  for (const FormDescription& form : command.forms) {
    text << Options(command, form);
  }
  text << kExitStatus << ".SH EXAMPLES\n.nf\n";
  for (const FormDescription& form : command.forms) {
    text << TroffText(program.name) << " " << TroffText(form.example) << "\n";
  }
  text << ".fi\n" << SeeAlso(program, command.name);
  return text.str();
}

}  // namespace tsar
