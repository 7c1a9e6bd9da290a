// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/refine_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/report/debug_pictures.h"

#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>

namespace tsar {
namespace {

constexpr const char* kGroup = "TsarRefine.";
constexpr const char* kSummary =
    "Completes the depth and normal maps of a dense workspace where surfaces "
    "have no texture: it removes wrong depths, spreads right ones and fits "
    "planes to walls, floors and facades. Run it after patch_match_stereo and "
    "before stereo_fusion. The refined maps take the names of the originals, "
    "so that stereo_fusion needs no other options; the originals are kept in "
    "stereo/tsar and --restore 1 puts them back. Beside the maps it writes how "
    "sure each depth is (stereo/confidence_maps, stereo/sigma_maps), where it "
    "comes from (stereo/provenance_maps), which plane it lies on "
    "(stereo/plane_maps) and an account of the run "
    "(stereo/tsar/manifest.json). It can be interrupted at any time: the same "
    "command goes on where it stopped. A run with other options begins from "
    "the originals again.";

void AddWorkspaceOptions(RefineCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace.workspace_path,
                       "The dense workspace, as image_undistorter makes it and "
                       "patch_match_stereo fills it.");
  AddMapType("input_type",
             &command->input_type,
             "Which maps to refine; the others serve as evidence where "
             "they exist. If not given: geometric, or photometric where "
             "there are no geometric ones.",
             options);
  options->Add("image_list_path",
               &command->workspace.image_list_path,
               "A text file with one image name per line: refine these alone, "
               "to the same maps as among all. The others serve as sources, "
               "and stay as they are. If empty, refine all.");
  AddMaskPath(&command->workspace.mask_path,
              "Where a mask is black (0), what the maps hold is no evidence "
              "for anything, and the refined maps have no depth. Images "
              "without a mask are used as a whole.",
              options);
  AddPriorOptions(
      "", &command->workspace.prior_path, &command->prior_type, options);
  options->Add("region_path",
               &command->workspace.region_path,
               "The folder with label images of the undistorted images, "
               "a.jpg.png or a.png for a.jpg, of any program for segmentation: "
               "PNG files of one channel with 8 or 16 bits, a number for each "
               "segment, which is one face or one object, and 0 for none. "
               "The planes of a segment replace those of the regions between "
               "image edges where most depths measured in it contradict these "
               "and confirm its own. Images may be without one.");
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
  options->AddChoice(group + "preset",
                     &command->preset,
                     {"default", "paper", "paper_strict"},
                     "The method of this project; the published one as this "
                     "project reads it; or its equations as printed, for "
                     "scenes in meters. Options that are given come on top.");
  AddDeviceArguments(
      group,
      &command->devices,
      options,
      " On the CPU, those that compute; a few more read and write files. With "
      "GPUs, two fifths of them read files and as many write, at most ten per "
      "GPU.");
#if TSAR_TOOL_REPORT
  options->Add(
      group + "debug_path",
      &command->debug_path,
      "Write a picture (PNG) of every intermediate result here, in a "
      "folder for each image; nothing but such pictures may be there. The maps "
      "stay the same; it takes longer, "
      "and images that were done before are done again. Depth is red "
      "near and blue far; normals as tsar_report shows them; values "
      "dark violet where they are 0 and yellow where they are largest; "
      "labels a color each; black is none. The pictures: " +
          DebugPicturesText() + ".");
#endif
  options->Add(group + "shard",
               &command->shard,
               "For several machines with one file system: the part of the "
               "images to work on, i/n with i from 0 to n - 1; docs/cluster.md "
               "tells how. If empty, all of them.");
  options->AddChoice(group + "pass",
                     &command->pass,
                     {"all", "observe", "model", "compose", "merge"},
                     "What to do of it. A shard is observed; once all are, one "
                     "program finds the planes of the scene (model), then each "
                     "shard is composed; merge ends the work of all shards.");
}

OptionRange RangeOf(const RefineField& field) {
  return std::holds_alternative<bool*>(field.value)
             ? OptionRange{}
             : OptionRange{field.min, field.max};
}

OptionTarget TargetOf(const RefineField& field) {
  return std::visit([](auto* value) { return OptionTarget(value); },
                    field.value);
}

void AddRefineOptions(RefineCommand* command, OptionSet* options) {
  RefineOptions paper = PresetOptions(RefinePreset::kPaper);
  RefineOptions strict = PresetOptions(RefinePreset::kPaperStrict);
  const std::vector<RefineField> of_paper = ListRefineFields(&paper);
  const std::vector<RefineField> of_strict = ListRefineFields(&strict);
  const std::vector<RefineField> fields = ListRefineFields(&command->refine);
  std::vector<Option> settings;
  for (size_t i = 0; i < fields.size(); ++i) {
    const RefineField& field = fields[i];
    if (field.is_option) {
      options->Add(kGroup + field.name,
                   TargetOf(field),
                   field.description,
                   RangeOf(field));
      continue;
    }
    Option setting{
        field.name, field.description, TargetOf(field), RangeOf(field)};
    if (of_paper[i].Text() != field.Text()) {
      setting.presets["paper"] = of_paper[i].Text();
    }
    if (of_strict[i].Text() != field.Text()) {
      setting.presets["paper_strict"] = of_strict[i].Text();
    }
    settings.push_back(std::move(setting));
  }
  options->AddSettings(
      std::string(kGroup) + "experiment",
      &command->experiment,
      std::move(settings),
      "Changes of the method, for experiments: values whose defaults we know "
      "better than users can, such as segment=0,edge_threshold=8. help lists "
      "all, with their meaning and values in the presets.");
}

int RestoreWorkspace(const RefineCommand& command) {
  const WorkspaceRefineOptions& given = command.workspace;
  const auto refuse = [](const std::filesystem::path& path,
                         const std::string& option,
                         const std::string& reason) {
    if (!path.empty()) {
      throw Error(ErrorCode::kBadOption,
                  "--restore " + reason + "; leave " + option + " out");
    }
  };
  refuse(given.output_path, "--output_path", "puts maps back in place");
  refuse(given.image_list_path,
         "--image_list_path",
         "puts the maps of all images back");
  refuse(given.mask_path, "--mask_path", "puts whole maps back");
  refuse(given.prior_path, "--prior_path", "puts maps back as they were");
  refuse(given.region_path, "--region_path", "looks at no regions");
  const WorkspaceLock lock(given.workspace_path);
  const RestoreResult result = Restore(given.workspace_path);
  std::cout << "Put the original maps of "
            << Counted(result.num_restored, "image") << " back.\n";
  ReportRestored(result);
  return 0;
}

}  // namespace

void RefineCommand::AddTo(OptionSet* options) {
  AddWorkspaceOptions(this, options);
  AddRunOptions(this, options);
  AddRefineOptions(this, options);
}

void RefineCommand::UsePreset() {
  refine = PresetOptions(preset == "paper"          ? RefinePreset::kPaper
                         : preset == "paper_strict" ? RefinePreset::kPaperStrict
                                                    : RefinePreset::kDefault);
}

RunSummary RefineCommand::Run(Progress& progress,
                              const std::function<bool()>& should_stop) const {
  WorkspaceRefineOptions parsed = workspace;
  parsed.prior_type = ParsePriorType(prior_type);
  parsed.input_type = ParseMapType(input_type);
  parsed.devices = devices.Parse();
  parsed.shard = ParseShard(shard);
  parsed.pass = ParsePass(pass);
  std::unique_ptr<RefineObserver> pictures;
#if TSAR_TOOL_REPORT
  if (!debug_path.empty()) {
    parsed.Check();
    refine.Check();
    const std::string option = OptionName("debug_path");
    if (parsed.pass != RefinePass::kAll) {
      throw Error(ErrorCode::kBadOption,
                  option + ": shards draw no pictures; leave it out, or run " +
                      OptionName("pass") + " all");
    }
    for (const auto& root : {parsed.workspace_path, parsed.output_path}) {
      if (!root.empty()) {
        RequireOutsideInputs(root, debug_path, option);
      }
    }
    pictures = std::make_unique<DebugPictures>(debug_path);
  }
#endif
  return RefineWorkspace(parsed, refine, progress, should_stop, pictures.get());
}

int RunTsarRefine(int argc, char** argv) {
  RefineCommand command;
  OptionSet options(
      "tsar_refine", kSummary, "tsar_refine --workspace_path dense");
  command.AddTo(&options);
  options.Add("random_seed",
              &command.refine.seed,
              "The name that COLMAP's commands have for --TsarRefine.seed.",
              {0, std::numeric_limits<int>::max()});
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
  if (summary.RefinedNone()) {
    // The next command would find no refined maps.
    const RunSummary::KeptImage& first = summary.kept.front();
    throw Error(ErrorCode::kNotFound,
                command.workspace.workspace_path.string() +
                    ": no image could be refined; " + first.name + ": " +
                    first.reason);
  }
  return 0;
}

}  // namespace tsar
