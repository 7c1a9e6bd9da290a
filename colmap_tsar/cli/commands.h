// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// A command takes the arguments that follow the program's name, argv[0] being
// the command's own name, as COLMAP calls its commands, and returns the exit
// code. It throws tsar::Error; RunCommand reports it.
using CommandFunction = int (*)(int argc, char** argv);

struct Command {
  std::string name;
  std::string summary;  // One line.
  CommandFunction function = nullptr;
};

// All commands, in the order in which the help lists them.
const std::vector<Command>& Commands();

// Calls the function; prints any exception as one line "ERROR: ..." to standard
// error and returns 1 for it.
int RunCommand(CommandFunction function, int argc, char** argv);

// The whole program: finds the command named by argv[1] and runs it, or prints
// help or version. Returns the exit code.
int RunProgram(int argc, char** argv);

// Refines the depth and normal maps of a dense workspace, or restores them.
int RunTsarRefine(int argc, char** argv);

// Draws the depth before and after refinement.
int RunTsarReport(int argc, char** argv);

// Scores depth maps or a point cloud against ground truth.
int RunTsarEvaluate(int argc, char** argv);

}  // namespace tsar
