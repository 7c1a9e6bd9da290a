// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/report_command.h"
#include "colmap_tsar/report/write_page.h"
#include "colmap_tsar/store/workspace.h"

#include <iostream>
#include <string>

#include <unistd.h>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Writes a page about a refined workspace, to be opened in a browser from "
    "the disk: for every image depth and normals before and after, how sure "
    "each depth is and where it comes from; a 3D view of the points before and "
    "after, and one of the planes of the scene with a list of them; and the "
    "gain, where there is ground truth. It is one folder that "
    "can be moved and sent, and needs neither a server nor a network; open its "
    "index.html. With --output_path it draws one picture (PNG) of some images "
    "instead, or as well where --report_path is given.";

void WriteReport(const Workspace& workspace, const ReportCommand& command) {
  const PageOptions page = command.Page(workspace);
  // Before the page is there: from then on, memory may be short without the run
  // having failed.
  const std::string index =
      Printable((page.report_path / "index.html").string());
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  const int num_images = WritePage(
      workspace, page, progress, [&] { return interruption.Requested(); });
  std::cout << "Wrote a page about " << num_images
            << (num_images == 1 ? " image" : " images") << "\nOpen " << index
            << " in a browser" << std::endl;
}

}  // namespace

int RunTsarReport(int argc, char** argv) {
  ReportCommand command;
  OptionSet options("tsar_report",
                    kSummary,
                    "tsar_report --workspace_path dense --after_path "
                    "fused.ply");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  const Workspace workspace = command.Open();
  if (command.WantsPicture()) {
    command.WritePicture(workspace);
    std::cout << "Wrote " << Printable(command.output_path) << std::endl;
  }
  if (command.WantsPage()) {
    WriteReport(workspace, command);
  }
  return 0;
}

}  // namespace tsar
