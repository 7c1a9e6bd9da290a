// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/report_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/fusion/fuse_workspace.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"
#include "colmap_tsar/tools/report/comparison_picture.h"
#include "colmap_tsar/tools/report/pictures.h"

#include <filesystem>
#include <functional>
#include <iostream>
#include <vector>

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

// num_threads: see DeviceOptions.
FuseMaps FuseBy(FusionPreset preset, int num_threads) {
  FuseWorkspaceOptions options;
  options.fusion = PresetFusionOptions(preset);
  options.devices.num_threads = num_threads;
  return [options](const Workspace& workspace,
                   bool originals,
                   const std::filesystem::path& cloud,
                   Progress& progress,
                   const std::function<bool()>& should_stop) {
    FuseWorkspaceOptions of_maps = options;
    of_maps.originals = originals;
    of_maps.output_path = cloud;
    FuseWorkspace(workspace, of_maps, progress, should_stop);
  };
}

void WriteReport(const Workspace& workspace, const ReportCommand& command) {
  const PageOptions page = command.Page(workspace);
  // The text is made before the page exists: from then on, memory may run out
  // without the run having failed.
  const std::string index =
      Printable((page.report_path / "index.html").string());
  const int num_images =
      RunInterruptibly([&](Progress& progress, const auto& should_stop) {
        return WritePage(workspace, page, progress, should_stop);
      });
  if (!page.after_path.empty() && page.before_path.empty() && !page.fuse) {
    Warn(
        "no --before_path: the page compares the cloud after with points of "
        "the maps before that are not fused; to compare like with like, let "
        "--fuse default make both clouds, or --fuse colmap the one before "
        "where stereo_fusion made the one after");
  }
  std::cout << "Wrote a page about " << Counted(num_images, "image")
            << "\nOpen " << index << " in a browser" << std::endl;
}

void AddPageOptions(ReportCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace_path,
                       "The refined dense workspace.");
  AddMapType(
      "input_type",
      &command->input_type,
      "The maps that were refined. If not given: geometric, or photometric "
      "where only those were.",
      options);
  options->Add(
      "report_path",
      &command->page.report_path,
      "The folder of the page. If not given: report in the workspace.");
  options->Add("overwrite",
               &command->page.overwrite,
               "Replace an earlier page in that folder, and the file that "
               "--output_path names. A folder with anything else in it, also "
               "in the folders of a page, is never touched.");
  AddPriorOptions(
      " The page shows each prior in the colors of the depth beside it.",
      &command->prior_path,
      &command->prior_type,
      options);
  options->Add(
      "before_path",
      &command->page.before_path,
      "The cloud (PLY) that stereo_fusion made of the maps before, for "
      "the 3D view. If not given, the view shows points of the original maps "
      "themselves.");
  options->Add("after_path",
               &command->page.after_path,
               "The cloud that it made of the refined maps. If not given, "
               "neither may --before_path be, and the view shows points of "
               "these maps.");
  options->AddChoice(
      "fuse",
      &command->fuse,
      FusionPresetNames(),
      "Fuse the clouds that --before_path and --after_path do not give, as "
      "tsar_fuse with this --TsarFuse.preset: the one before of the maps that "
      "tsar_refine kept. They are made for the page alone and not kept. "
      "Compare a cloud of stereo_fusion with one by colmap.");
}

void AddScoreOptions(ReportCommand* command, OptionSet* options) {
  options->Add("ground_truth_path",
               &command->page.ground_truth_path,
               "Depth maps to score the maps against, before and after, as "
               "tsar_evaluate depth takes them.");
  options->Add(
      "scans_path",
      &command->page.scans_path,
      "Laser scans to score both clouds against: a MeshLab project, as "
      "tsar_evaluate cloud takes it.");
  options->Add("tolerances",
               &command->tolerances,
               "Errors below which a depth or a point is right; rising numbers "
               "with commas, in units of the model.");
}

void AddSizeOptions(ReportCommand* command, OptionSet* options) {
  options->Add("max_image_size",
               &command->page.max_picture_size,
               "Longer side of the page's pictures, in pixels. At 1000, an "
               "image takes about 2 megabytes.",
               {100, 100000});
  options->Add("max_points",
               &command->max_points,
               "Most points in the 3D view, before and after each.",
               {1, 20000000});
  AddNumThreads("num_threads",
                &command->page.num_threads,
                options,
                " Fewer where the images are too large for the main memory.");
  options->Add("output_path",
               &command->output_path,
               "The picture to draw, if any: a row for each image, with depth "
               "and normals before and after. A file that is there is replaced "
               "with --overwrite 1 alone.");
  options->Add("num_images",
               &command->num_images,
               "How many images that picture shows, spread evenly over the "
               "refined ones.",
               {1, 100});
}

}  // namespace

void ReportCommand::AddTo(OptionSet* options) {
  AddPageOptions(this, options);
  AddScoreOptions(this, options);
  AddSizeOptions(this, options);
}

void ReportCommand::Check() const {
  if (WantsPage()) {
    return;
  }
  const auto refuse = [](const std::string& key, bool is_given) {
    if (is_given) {
      throw Error(ErrorCode::kBadOption,
                  OptionName(key) + " is for a page, and with " +
                      OptionName("output_path") +
                      " alone there is none; give " +
                      OptionName("report_path") + ", too, or leave it out");
    }
  };
  refuse("before_path", !page.before_path.empty());
  refuse("after_path", !page.after_path.empty());
  refuse("fuse", !fuse.empty());
  refuse("ground_truth_path", !page.ground_truth_path.empty());
  refuse("scans_path", !page.scans_path.empty());
}

Workspace ReportCommand::Open() const {
  Workspace geometric(workspace_path, MapType::kGeometric);
  Workspace photometric(workspace_path, MapType::kPhotometric);
  const bool takes_photometric =
      input_type.empty() ? FindRefinedImages(geometric).empty() &&
                               !FindRefinedImages(photometric).empty()
                         : input_type == ToString(MapType::kPhotometric);
  Workspace workspace = takes_photometric ? photometric : geometric;
  const PriorType type = ParsePriorType(prior_type);
  RequirePathOfPriorType(prior_path, type);
  workspace.UsePriors(prior_path, type);
  workspace.Priors().WarnOfStrayFiles();
  return workspace;
}

void ReportCommand::WritePicture(const Workspace& workspace) const {
  RequireWritableOutput(workspace_path, output_path, "picture", page.overwrite);
  const std::vector<int> refined = FindRefinedImages(workspace);
  if (refined.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      workspace_path.string(),
                      "has no refined " + ToString(workspace.Type()) + " maps",
                      "run tsar_refine on it first");
  }
  std::vector<ComparisonRow> rows;
  for (const int image : PickEvenly(refined, num_images)) {
    rows.push_back(ReadComparisonRow(workspace, image));
  }
  WritePng(UserPath(output_path), DrawComparison(rows));
}

PageOptions ReportCommand::Page(const Workspace& workspace) const {
  PageOptions result = page;
  if (page.report_path.empty()) {
    result.report_path = workspace.Root() / "report";
  }
  result.tolerances = ParseTolerances(tolerances);
  result.max_num_points = max_points;
  if (!fuse.empty()) {
    result.fuse = FuseBy(ParseFusionPreset(fuse), page.num_threads);
    result.fusion = "tsar_fuse --TsarFuse.preset " + fuse;
  }
  return result;
}

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
  command.Check();
  const Workspace workspace = command.Open();
  if (command.WantsPicture()) {
    command.WritePicture(workspace);
    std::cout << "Wrote " << Printable(command.output_path.string())
              << std::endl;
  }
  if (command.WantsPage()) {
    WriteReport(workspace, command);
  }
  return 0;
}

}  // namespace tsar
