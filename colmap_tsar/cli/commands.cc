// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/cli/process_setup.h"

#include <algorithm>
#include <csignal>
#include <iomanip>
#include <iostream>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

// The function with its errors reported.
template <CommandFunction kFunction>
int Reported(int argc, char** argv) {
  return RunCommand(kFunction, argc, argv);
}

const char kSummary[] =
    "Completes the depth maps of COLMAP's dense stage on surfaces without "
    "texture.";

void PrintProgramHelp() {
  std::cout << kSummary
            << "\n\nUsage:\n  colmap_tsar COMMAND [options]\n\nCommands:\n";
  size_t width = 0;
  for (const Command& command : Commands()) {
    width = std::max(width, command.name.size());
  }
  for (const Command& command : Commands()) {
    std::cout << "  " << std::left << std::setw(static_cast<int>(width) + 2)
              << command.name << command.summary << "\n";
  }
  std::cout << "\ncolmap_tsar COMMAND --help explains a command, --version "
               "prints the version,\n--help_json these lines as JSON.\n";
}

// Prints the help as JSON, for programs: the "summary", the "version" and the
// "commands", each with "name" and "summary".
void PrintProgramHelpJson() {
  nlohmann::ordered_json json;
  json["summary"] = kSummary;
  json["version"] = TSAR_VERSION;
  json["commands"] = nlohmann::ordered_json::array();
  for (const Command& command : Commands()) {
    json["commands"].push_back(
        {{"name", command.name}, {"summary", command.summary}});
  }
  std::cout << json.dump(2) << "\n";
}

// Handles the arguments where no command is named.
int TellAboutProgram(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "help";
  if (name == "help" || name == "-h" || name == "--help" ||
      name == "--help_all") {
    PrintProgramHelp();
  } else if (name == "--help_json") {
    PrintProgramHelpJson();
  } else if (name == "--version") {
    std::cout << "colmap_tsar " TSAR_VERSION
              << (TSAR_CUDA_ENABLED ? " (with CUDA)\n" : " (without CUDA)\n");
  } else {
    std::string list;
    for (const Command& command : Commands()) {
      list += (list.empty() ? "" : ", ") + command.name;
    }
    throw Error(ErrorCode::kBadOption,
                "unknown command '" + name + "'; the commands are " + list);
  }
  return 0;
}

}  // namespace

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {
#if TSAR_TOOL_STEREO && TSAR_TOOL_REPORT
    {"tsar_reconstruct",
     "Make a point cloud of posed images: stereo, refinement, fusion",
     &Reported<&RunTsarReconstruct>},
#endif
    {"tsar_refine",
     "Complete the depth and normal maps before stereo_fusion",
     &Reported<&RunTsarRefine>},
#if TSAR_TOOL_STEREO
    {"tsar_stereo",
     "Make the depth and normal maps from the images",
     &Reported<&RunTsarStereo>},
#endif
    {"tsar_fuse",
     "Fuse the depth maps into a point cloud",
     &Reported<&RunTsarFuse>},
#if TSAR_TOOL_IMPORT
    {"tsar_import",
     "Make a workspace of depth of other programs and sensors",
     &Reported<&RunTsarImport>},
#endif
#if TSAR_TOOL_REPORT
    {"tsar_report",
     "Write a page that shows maps and points before and after",
     &Reported<&RunTsarReport>},
#endif
#if TSAR_TOOL_PLANE_EXPORT
    {"tsar_planes",
     "Write walls, floors and other planes of a refined workspace",
     &Reported<&RunTsarPlanes>},
#endif
#if TSAR_TOOL_EVALUATION
    {"tsar_evaluate",
     "Score depth maps or a point cloud against ground truth",
     &Reported<&RunTsarEvaluate>},
#endif
  };
  return commands;
}

int RunCommand(CommandFunction function, int argc, char** argv) {
  OpenClosedStandardStreams();
  // A write beyond the file size limit (ulimit -f) should fail, like one to a
  // full disk; otherwise the system would end the process.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    PrepareForLowMemory();
    const OpenCvWithoutThreads opencv_without_threads;
    const int exit_code = function(argc, argv);
    FlushStandardOutput();
    return exit_code;
  } catch (...) {
    ReportFailure();
  }
  return 1;
}

int RunProgram(int argc, char** argv) {
  for (const Command& command : Commands()) {
    if (argc > 1 && command.name == argv[1]) {
      argv[1] = argv[0];
      return command.run(argc - 1, argv + 1);
    }
  }
  return RunCommand(&TellAboutProgram, argc, argv);
}

}  // namespace tsar
