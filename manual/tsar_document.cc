// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Writes the manual pages and the shell completions of colmap_tsar, from the
// same table of options as its --help, into a folder:
//
//   tsar_document FOLDER
//
//   FOLDER/man1/*.1, FOLDER/bash, FOLDER/zsh, FOLDER/fish

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "manual/completion.h"
#include "manual/man_page.h"
#include "manual/program_description.h"

namespace tsar {

std::string FirstSentence(const std::string& text) {
  const size_t end = text.find(". ");
  if (end != std::string::npos) {
    return text.substr(0, end);
  }
  return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
}

std::string Join(const std::vector<std::string>& texts,
                 const std::string& separator) {
  std::string joined;
  for (const std::string& text : texts) {
    joined += (joined.empty() ? "" : separator) + text;
  }
  return joined;
}

namespace {

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

void WriteAll(const std::filesystem::path& folder) {
  const ProgramDescription program = DescribeProgram();
  const std::filesystem::path pages = folder / "man1";
  std::filesystem::create_directories(pages);
  WriteText(pages / (program.name + ".1"), ProgramManPage(program));
  for (const CommandDescription& command : program.commands) {
    WriteText(pages / (program.name + "-" + command.name + ".1"),
              CommandManPage(program, command));
  }
  WriteText(folder / "bash", BashCompletion(program));
  WriteText(folder / "zsh", ZshCompletion(program));
  WriteText(folder / "fish", FishCompletion(program));
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: tsar_document FOLDER\n";
    return 2;
  }
  try {
    tsar::WriteAll(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
