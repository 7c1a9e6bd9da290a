// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/refine_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <iostream>
#include <limits>
#include <utility>
#include <variant>

namespace tsar {
namespace {

constexpr const char* kGroup = "TsarRefine.";
constexpr const char* kSummary =
    "Completes the depth and normal maps of a dense workspace where surfaces "
    "have no texture: it removes wrong depths, spreads right ones and fits "
    "planes to walls, floors and facades. Run it after patch_match_stereo and "
    "before stereo_fusion, which needs no other options: refined maps take the "
    "names of the originals, and --restore 1 puts these back. Beside them it "
    "writes how sure each depth is (stereo/confidence_maps, "
    "stereo/sigma_maps), where it comes from (stereo/provenance_maps), its "
    "plane (stereo/plane_maps) and an account of the run "
    "(stereo/tsar/manifest.json). It can be interrupted at any time: the same "
    "command goes on where it stopped.";

void AddWorkspaceOptions(RefineCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace.workspace_path,
                       "The dense workspace, as image_undistorter makes it and "
                       "patch_match_stereo fills it.");
  AddInputType(
      &command->workspace.input_type,
      "The maps to refine. If not given: geometric, or photometric where "
      "there are no others.",
      options);
  options->Add("image_list_path",
               &command->workspace.image_list_path,
               "A text file with one image name per line: refine these alone, "
               "to the same maps as among all. If empty, all.");
  AddMaskPath(&command->workspace.mask_path,
              "Where a mask is black (0), what the maps hold is no evidence, "
              "and the refined maps have no depth.",
              options);
  options->Add("prior_path",
               &command->workspace.prior_path,
               "The folder with depth priors of the undistorted images, of a "
               "network or a sensor: a.jpg.EXT for a.jpg, normals "
               "a.jpg.normal.EXT; npy, exr, pfm, png, tif (docs/guide.md).");
  options->AddEnum<PriorType>(
      "prior_type",
      &command->workspace.prior_type,
      {PriorType::kAuto,
       PriorType::kMetric,
       PriorType::kRelative,
       PriorType::kInverse},
      "What they hold. metric: depth times one factor for each image; "
      "relative: the same plus a constant; inverse: 1 / depth times a factor "
      "plus a constant; auto: what fits best.");
  options->Add("output_path",
               &command->workspace.output_path,
               "Write a second workspace here, with links to the images, and "
               "leave the first as it is. If empty, refine in place.");
  options->Add("restore",
               &command->restore,
               "Put the original maps back, remove all that tsar_refine wrote, "
               "and do nothing else. What others wrote in their place since is "
               "never removed.");
}

void AddRunOptions(RefineCommand* command, OptionSet* options) {
  const std::string group = kGroup;
  options
      ->Add(group + "preset",
            &command->preset,
            "The method of this project, or the published one. "
            "Options that are given come on top.")
      .choices = {"default", "paper"};
  AddDeviceOptions(group, &command->workspace.devices, options);
  Shard* const shard = &command->workspace.shard;
  options->Add(
      group + "shard",
      TextTarget{
          [shard] { return shard->count == 1 ? "" : ToString(*shard); },
          [shard](const std::string& text) { *shard = ParseShard(text); }},
      "For several machines: the part of the images to work on, i/n "
      "with i from 0 to n - 1 (docs/cluster.md). If empty, all.");
  options->AddEnum<RefinePass>(
      group + "pass",
      &command->workspace.pass,
      {RefinePass::kAll,
       RefinePass::kObserve,
       RefinePass::kModel,
       RefinePass::kCompose,
       RefinePass::kMerge},
      "What to do of it: observe each shard, then model once, "
      "compose each shard, and merge once.");
}

// The members of RefineOptions. Most are for experiments: we know their values
// better than users can.
void AddRefineOptions(RefineOptions* refine, OptionSet* options) {
  RefineOptions paper = PresetOptions(RefinePreset::kPaper);
  const std::vector<RefineField> of_paper = ListRefineFields(&paper);
  const std::vector<RefineField> fields = ListRefineFields(refine);
  for (size_t i = 0; i < fields.size(); ++i) {
    const RefineField& field = fields[i];
    const std::string value = of_paper[i].Text();
    Option& option = options->Add(
        kGroup + field.name,
        std::visit([](auto* member) { return OptionTarget(member); },
                   field.value),
        field.description + (value == field.Text()
                                 ? ""
                                 : " In the preset paper: " + value + "."),
        {field.min, field.max});
    option.is_advanced = !field.is_option;
  }
}

int RestoreWorkspace(const RefineCommand& command) {
  const WorkspaceRefineOptions& given = command.workspace;
  for (const auto& [option, path] :
       {std::pair("--output_path", given.output_path),
        std::pair("--image_list_path", given.image_list_path),
        std::pair("--mask_path", given.mask_path),
        std::pair("--prior_path", given.prior_path)}) {
    if (!path.empty()) {
      throw Error(ErrorCode::kBadOption,
                  "--restore puts the maps of all images back as they were; "
                  "leave " +
                      std::string(option) + " out");
    }
  }
  const WorkspaceLock lock(given.workspace_path);
  const RestoreResult result = Restore(given.workspace_path);
  PrintSummary(result, std::cout);
  if (!result.lost.empty()) {
    throw Error(ErrorCode::kMismatch,
                AndMore(result.lost.front().string(), result.lost.size()) +
                    ": this map has been refined, and its original is gone; "
                    "run patch_match_stereo again for this image");
  }
  return 0;
}

}  // namespace

void RefineCommand::AddTo(OptionSet* options) {
  AddWorkspaceOptions(this, options);
  AddRunOptions(this, options);
  AddRefineOptions(&refine, options);
}

void RefineCommand::UsePreset() {
  refine = PresetOptions(preset == "paper" ? RefinePreset::kPaper
                                           : RefinePreset::kDefault);
}

RunSummary RefineCommand::Run(Progress& progress) const {
  return RefineWorkspace(workspace, refine, progress);
}

void RequireRefined(const RunSummary& summary) {
  if (summary.RefinedNone()) {
    const RunSummary::KeptImage& first = summary.kept.front();
    throw Error(ErrorCode::kNotFound,
                summary.workspace_path.string() +
                    ": no image could be refined; " + first.name + ": " +
                    first.reason);
  }
}

int RunTsarRefine(int argc, char** argv) {
  RefineCommand command;
  OptionSet options(
      "tsar_refine", kSummary, "tsar_refine --workspace_path dense");
  // Before TsarRefine.seed, which overrides it: in COLMAP's project files
  // random_seed=0 is at the top.
  options
      .Add("random_seed",
           &command.refine.seed,
           "The name that COLMAP's commands have for --TsarRefine.seed.",
           {0, std::numeric_limits<int>::max()})
      .is_advanced = true;
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  command.UsePreset();
  options.Parse(argc, argv);
  if (command.restore) {
    return RestoreWorkspace(command);
  }
  const RunSummary summary =
      RunInterruptibly(std::bind_front(&RefineCommand::Run, &command));
  PrintSummary(summary, std::cout);
  RequireRefined(summary);
  PrintNext(summary, std::cout);
  return 0;
}

}  // namespace tsar
