// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// This header is valid C++14, since older versions of COLMAP include it.

#include <string>
#include <vector>

namespace tsar {

// A function that is called as COLMAP calls its commands: argv[0] is the
// program's name, the command's arguments follow. Returns the exit code.
using CommandFunction = int (*)(int argc, char** argv);

struct Command {
  std::string name;
  std::string summary;  // One line.
  CommandFunction run;  // Reports errors as RunCommand does; never throws.
};

// All commands of this build (cmake/TsarTools.cmake), in the order of the help,
// for registration by a program that contains them (this project's own, or a
// COLMAP built with one of patches/).
const std::vector<Command>& Commands();

// Calls the function; prints any exception as one line "ERROR: ..." to standard
// error and returns 1 for it.
int RunCommand(CommandFunction function, int argc, char** argv);

// The whole program: finds the command named by argv[1] and runs it, or prints
// help (also of a command, as it does with --help) or version. Returns the exit
// code.
int RunProgram(int argc, char** argv);

// The commands themselves, which throw tsar::Error.
int RunTsarReconstruct(int argc, char** argv);
int RunTsarRefine(int argc, char** argv);
int RunTsarStereo(int argc, char** argv);
int RunTsarFuse(int argc, char** argv);
int RunTsarImport(int argc, char** argv);
int RunTsarReport(int argc, char** argv);
int RunTsarPlanes(int argc, char** argv);
int RunTsarEvaluate(int argc, char** argv);

}  // namespace tsar
