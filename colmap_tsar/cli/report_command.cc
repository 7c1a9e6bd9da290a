// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/report_command.h"

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <iostream>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Writes a page about a refined workspace, to be opened in a browser from "
    "the disk: for every image the photo, depth and normals before and after, "
    "what each depth is and how sure it is; a table of numbers; and the "
    "options of the run. It is one folder that can be moved and sent, and "
    "needs neither a server nor a network; open its index.html.";

}  // namespace

void ReportCommand::AddTo(OptionSet* options) {
  options->AddRequired(
      "workspace_path", &workspace_path, "The refined dense workspace.");
  AddInputType(
      &input_type,
      "The maps that were refined. If not given: geometric, or photometric "
      "where only those were.",
      options);
  options->Add(
      "report_path",
      &page.report_path,
      "The folder of the page. If not given: report in the workspace.");
  options->Add("overwrite",
               &page.overwrite,
               "Replace an earlier page in that folder. A folder with anything "
               "else in it, also in the folders of a page, is never touched.");
  options->Add("max_image_size",
               &page.max_picture_size,
               "Longer side of the page's pictures, in pixels. At 1000, an "
               "image takes about 2 megabytes.",
               {100, 100000});
  AddNumThreads("num_threads",
                &page.num_threads,
                options,
                " Fewer where the images are too large for the main memory.");
}

ReportSummary ReportCommand::Run(Progress& progress) const {
  const Workspace workspace = OpenWorkspaceWithMaps(workspace_path, input_type);
  PageOptions options = page;
  if (options.report_path.empty()) {
    options.report_path = workspace.Root() / "report";
  }
  ReportSummary summary;
  summary.page_path = options.report_path / "index.html";
  summary.num_images = WritePage(workspace, options, progress);
  return summary;
}

int RunTsarReport(int argc, char** argv) {
  ReportCommand command;
  OptionSet options(
      "tsar_report", kSummary, "tsar_report --workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  const ReportSummary summary =
      RunInterruptibly(std::bind_front(&ReportCommand::Run, &command));
  std::cout << "Wrote a page about " << Counted(summary.num_images, "image")
            << "\nOpen " << Printable(summary.page_path.string())
            << " in a browser" << std::endl;
  return 0;
}

}  // namespace tsar
