// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/fuse_command.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/refine_command.h"
#include "colmap_tsar/cli/report_command.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/cli/stereo_command.h"
#include "colmap_tsar/run/store/input_folders.h"

#include <functional>
#include <iostream>
#include <set>
#include <string>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Makes a point cloud of a dense workspace that has no maps yet, as "
    "image_undistorter leaves it: tsar_stereo, tsar_refine and tsar_fuse in "
    "one command, on NVIDIA GPUs and also without any, and tsar_report's page "
    "that shows what was done. It can be interrupted at any time: the same "
    "command goes on where it stopped; maps that are done are not made again, "
    "the cloud and the page are. It takes the options with a dot of the three "
    "commands, such as --TsarRefine.seed.";

struct ReconstructCommand {
  std::filesystem::path output_path;
  std::filesystem::path mask_path;
  bool stereo = true;
  DeviceOptions devices;
  StereoCommand match;
  RefineCommand refine;
  FuseCommand fuse;
  ReportCommand report;

  void AddTo(OptionSet* options);

  // Gives the commands what they have in common. Their own options have to be
  // set again afterwards.
  void HandOut();

  int Run(Progress& progress) const;
};

// Adds the options that a command has in a group, but those for which one value
// serves all commands, and those for several machines.
template <typename Command>
void AddGroup(Command* command, OptionSet* options) {
  const std::set<std::string> left_out = {
      "device", "gpu_index", "cache_size", "num_threads", "shard", "pass"};
  OptionSet all("", "", "");
  command->AddTo(&all);
  for (const Option& option : all.Options()) {
    const size_t dot = option.name.find('.');
    if (dot != std::string::npos &&
        !left_out.contains(option.name.substr(dot + 1))) {
      Option& added = options->Add(
          option.name, option.target, option.description, option.range);
      added.choices = option.choices;
      added.is_advanced = true;
    }
  }
}

void ReconstructCommand::AddTo(OptionSet* options) {
  options->AddRequired("workspace_path",
                       &match.workspace_path,
                       "The dense workspace, as image_undistorter makes it.");
  options->Add("output_path",
               &output_path,
               "The folder for the cloud, fused.ply with fused.ply.vis, and "
               "the page, report/index.html, which are made anew every time. "
               "If empty: reconstruction in the workspace.");
  AddMaskPath(&mask_path,
              "Where a mask is black (0), no depth is made, and none is "
              "evidence.",
              options);
  options->Add("stereo",
               &stereo,
               "Make the maps. 0: take those that are there, of "
               "patch_match_stereo or tsar_import.");
  options->Add("overwrite",
               &match.overwrite,
               "Replace maps that another program made (they are not kept), or "
               "that were made with other options or from other inputs.");
  AddDeviceOptions("TsarReconstruct.", &devices, options);
  AddGroup(&match, options);
  AddGroup(&refine, options);
  AddGroup(&fuse, options);
}

void ReconstructCommand::HandOut() {
  match.files.mask_path = mask_path;
  match.devices = devices;
  refine.workspace.workspace_path = match.workspace_path;
  refine.workspace.mask_path = mask_path;
  refine.workspace.devices = devices;
  refine.UsePreset();
  fuse.workspace_path = match.workspace_path;
  fuse.overwrite = true;
  fuse.options.mask_path = mask_path;
  fuse.options.devices = devices;
  fuse.UsePreset();
  if (output_path.empty()) {
    output_path = match.workspace_path / "reconstruction";
  }
  fuse.options.output_path = output_path / "fused.ply";
  report.workspace_path = match.workspace_path;
  report.page.report_path = output_path / "report";
  report.page.overwrite = true;
  report.page.num_threads = devices.num_threads;
}

int ReconstructCommand::Run(Progress& progress) const {
  // Before hours are spent.
  RequireOutsideInputs(
      match.workspace_path, output_path, OptionName("output_path"));
  if (std::filesystem::is_directory(output_path)) {
    fuse.CheckOutput();
  }
  if (stereo) {
    progress.SetPart("Stereo. ");
    PrintSummary(match.Run(progress), std::cout);
  }
  progress.SetPart("Refinement. ");
  const RunSummary refined = refine.Run(progress);
  PrintSummary(refined, std::cout);
  RequireRefined(refined);
  progress.SetPart("");
  CreateFolders(UserPath(output_path));
  PrintSummary(fuse.Run(progress), fuse.options.output_path, std::cout);
  progress.SetPart("Page:");
  const ReportSummary page = report.Run(progress);
  std::cout << "Open " << Printable(page.page_path.string()) << " in a browser"
            << std::endl;
  return 0;
}

}  // namespace

int RunTsarReconstruct(int argc, char** argv) {
  ReconstructCommand command;
  OptionSet options(
      "tsar_reconstruct", kSummary, "tsar_reconstruct --workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  command.HandOut();
  options.Parse(argc, argv);
  return RunInterruptibly(std::bind_front(&ReconstructCommand::Run, &command));
}

}  // namespace tsar
