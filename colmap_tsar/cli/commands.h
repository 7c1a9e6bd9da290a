// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// C++14 suffices for this header, since older versions of COLMAP include it.

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

// All commands of this build (cmake/TsarTools.cmake), in the order in which the
// help lists them, for registration by a program that contains them (this
// project's own, or a COLMAP built with one of patches/).
const std::vector<Command>& Commands();

// Calls the function; prints any exception as one line "ERROR: ..." to standard
// error and returns 1 for it.
int RunCommand(CommandFunction function, int argc, char** argv);

// The whole program: finds the command named by argv[1] and runs it, or prints
// help (also of a command, as it does with --help) or version. Returns the exit
// code.
int RunProgram(int argc, char** argv);

// The commands themselves, which throw tsar::Error.

// Refines the depth and normal maps of a dense workspace, or restores them.
int RunTsarRefine(int argc, char** argv);

// Makes the maps of a dense workspace from its images.
int RunTsarStereo(int argc, char** argv);

// Fuses the maps of a dense workspace into a point cloud.
int RunTsarFuse(int argc, char** argv);

// Imports the maps of other programs into a dense workspace.
int RunTsarImport(int argc, char** argv);

// Draws the depth before and after refinement.
int RunTsarReport(int argc, char** argv);

// Writes the planes of a refined workspace.
int RunTsarPlanes(int argc, char** argv);

// Exports the maps of a workspace for other programs.
int RunTsarExport(int argc, char** argv);

// Scores depth maps or a point cloud against ground truth.
int RunTsarEvaluate(int argc, char** argv);

}  // namespace tsar
