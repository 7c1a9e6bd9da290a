// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"
#include "colmap_tsar/tools/evaluation/depth_evaluation.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

// Prints the evaluation as JSON, or its numbers ("images: 8" for num_images)
// and its "scores", which are at least one, as a table: a row for each.
void PrintEvaluation(const Json& evaluation, bool as_json) {
  if (as_json) {
    std::cout << evaluation.dump(2) << "\n";
    return;
  }
  TextStream table;
  for (const auto& [key, value] : evaluation.items()) {
    if (value.is_number()) {
      std::string name = key.substr(key.find('_') + 1);
      std::ranges::replace(name, '_', ' ');
      table << name << ": " << value << "\n";
    }
  }
  const auto print = [&](const std::string& column, const Json& value) {
    if (value.is_number() && column != "tolerance") {
      table << std::fixed << std::setprecision(4);
    } else {
      table << std::defaultfloat << std::setprecision(6);
    }
    table << (column == "area" ? std::left : std::right)
          << std::setw(column == "area" ? 12 : 13);
    value.is_number() ? table << value.get<double>()
                      : table << value.get<std::string>();
  };
  const Json& scores = evaluation.at("scores");
  for (const auto& [column, value] : scores.at(0).items()) {
    print(column, column == "f1" ? "F1" : column);
  }
  table << "\n";
  for (const Json& score : scores) {
    for (const auto& [column, value] : score.items()) {
      print(column, value);
    }
    table << "\n";
  }
  std::cout << table.str();
}

Json ToJson(const DepthEvaluation& evaluation) {
  Json json;
  json["num_images"] = evaluation.num_images;
  json["num_images_without_map"] = evaluation.num_images_without_map;
  if (evaluation.num_masks) {
    json["num_masks"] = *evaluation.num_masks;
  }
  for (const DepthScore& score : evaluation.scores) {
    json["scores"].push_back({{"area", score.area},
                              {"tolerance", score.tolerance},
                              {"precision", score.Precision()},
                              {"recall", score.Recall()},
                              {"f1", score.F1()}});
  }
  return json;
}

void AddTolerances(std::vector<double>* tolerances,
                   const std::string& description,
                   OptionSet* options) {
  const auto get = [tolerances] {
    TextStream text;
    for (const double tolerance : *tolerances) {
      text << (text.str().empty() ? "" : ",") << tolerance;
    }
    return text.str();
  };
  const auto set = [tolerances](const std::string& text) {
    *tolerances = ParseTolerances(text);
  };
  options->Add("tolerances", TextTarget{get, set}, description);
}

// Arguments of both evaluations of maps.
struct MapArguments {
  std::filesystem::path workspace_path;
  DepthEvaluationOptions options;
  bool json = false;

  // workspace, maps: descriptions. mask_effect: see AddMaskPath.
  void AddTo(OptionSet* set,
             const std::string& workspace,
             const std::string& maps,
             const std::string& mask_effect) {
    set->AddRequired("workspace_path", &workspace_path, workspace);
    AddInputType(&options.input_type, maps, set);
    set->Add("ground_truth_path",
             &options.ground_truth_path,
             "Folder with IMAGE_NAME.bin, depth maps in COLMAP's format, 0 "
             "= unknown. If empty, ground_truth/depth in the workspace.");
    AddMaskPath(&options.mask_path, mask_effect, set);
    AddTolerances(&options.tolerances,
                  "A depth is right if it is off by less than this; rising "
                  "numbers with commas, in units of the model (meters, if it "
                  "has them).",
                  set);
    set->Add("json", &json, "Print JSON instead of a table.");
  }
};

int EvaluateDepth(int argc, char** argv) {
  MapArguments arguments;
  OptionSet options(
      "tsar_evaluate depth",
      "Compares the depth maps of a COLMAP dense workspace with ground truth "
      "depth. Precision is the share of right depths among the estimated ones, "
      "recall the share of right depths among all pixels with ground truth, F1 "
      "their harmonic mean; each for all pixels and for textureless areas, "
      "where gray values vary by less than 4 of 255 levels (standard deviation "
      "in a window of 11 x 11 pixels).",
      "tsar_evaluate depth --workspace_path dense --tolerances 0.02,0.1");
  arguments.AddTo(&options,
                  "Folder of the dense workspace; its images are needed to "
                  "find the textureless areas.",
                  "Which of the depth maps to score.",
                  "Pixels where a mask is black (0) are not scored.");
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  const DepthEvaluation evaluation =
      EvaluateDepthMaps(arguments.workspace_path, arguments.options);
  PrintEvaluation(ToJson(evaluation), arguments.json);
  return 0;
}

Json ToJson(const CloudEvaluation& evaluation) {
  Json json;
  json["num_points"] = evaluation.num_points;
  json["num_scan_points"] = evaluation.num_scan_points;
  for (const CloudScore& score : evaluation.scores) {
    json["scores"].push_back({{"tolerance", score.tolerance},
                              {"completeness", score.completeness},
                              {"accuracy", score.accuracy},
                              {"f1", score.f1}});
  }
  return json;
}

int EvaluateCloud(int argc, char** argv) {
  CloudEvaluationOptions evaluation_options;
  std::filesystem::path input_path;
  std::filesystem::path ground_truth_path;
  bool json = false;
  OptionSet options(
      "tsar_evaluate cloud",
      "Compares a point cloud with laser scans by the measure of the ETH3D "
      "multi-view benchmark. Completeness is the share of the scanned surface "
      "that has a point within the tolerance, accuracy the share of points "
      "within the tolerance of the surface, F1 their harmonic mean; all are "
      "averaged over voxels. A point counts as wrong only where a laser beam "
      "passed through it; where no scanner looked it is not counted.",
      "tsar_evaluate cloud --input_path fused.ply --ground_truth_path "
      "scan_alignment.mlp");
  options.AddRequired("input_path",
                      &input_path,
                      "The cloud: a PLY file, ASCII or binary little-endian.");
  options.AddRequired("ground_truth_path",
                      &ground_truth_path,
                      "MeshLab project that lists the scans (PLY, each in its "
                      "scanner's frame) and their poses.");
  AddTolerances(&evaluation_options.tolerances,
                "Distances up to which a point is right; rising numbers with "
                "commas, in units of the scans (meters, if they have them).",
                &options);
  options.Add("voxel_size",
              &evaluation_options.voxel_size,
              "Edge length of the voxels, in units of the scans.");
  options.Add("beam_radius",
              &evaluation_options.beam.start_radius,
              "Radius of a laser beam at the scanner, in units of the scans.");
  options.Add("beam_angle",
              &evaluation_options.beam.divergence_degrees,
              "Half the opening angle of a laser beam, in degrees.");
  options.Add("json", &json, "Print JSON instead of a table.");
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  const CloudEvaluation evaluation =
      EvaluateCloudFile(input_path, ground_truth_path, evaluation_options);
  PrintEvaluation(ToJson(evaluation), json);
  return 0;
}

Json ToJson(const FusedPixelEvaluation& evaluation,
            const std::vector<double>& tolerances) {
  Json json;
  json["num_images"] = evaluation.num_images;
  json["num_known"] = evaluation.num_known;
  json["num_fused"] = evaluation.num_fused;
  const auto share = [](int64_t count, int64_t whole) {
    return static_cast<double>(count) /
           static_cast<double>(std::max<int64_t>(whole, 1));
  };
  for (size_t t = 0; t < tolerances.size(); ++t) {
    const int64_t num_right = evaluation.num_right[t];
    json["scores"].push_back(
        {{"tolerance", tolerances[t]},
         {"of_known", share(num_right, evaluation.num_known)},
         {"of_fused", share(num_right, evaluation.num_fused)}});
  }
  return json;
}

int RunEvaluateFusedPixels(int argc, char** argv) {
  MapArguments arguments;
  OptionSet options(
      "tsar_evaluate fused_pixels",
      "Fuses the maps of a dense workspace by the thresholds of the TSAR-MVS "
      "paper and compares, of each point, the pixel that became the point with "
      "ground truth depth, as in the paper's ablation. It tells how good the "
      "depths are that reach the cloud, each surface once, however many images "
      "see it. The share of right ones is given of the pixels with ground "
      "truth "
      "(most likely the paper's: its prior has 24.67 % right to 10 cm, while "
      "96.64 % "
      "of its cloud are) and of those that became a point.",
      "tsar_evaluate fused_pixels --workspace_path dense");
  arguments.AddTo(&options,
                  "Folder of the dense workspace, refined or not.",
                  "Which of the maps to fuse.",
                  "Where a mask is black (0), depths count as missing.");
  FusionOptions fusion = PresetFusionOptions("paper");
  options.Add("min_num_views",
              &fusion.min_num_views,
              "Images that have to agree on a point, its own included.",
              {1, kMaxFusionSources + 1});
  DeviceOptions devices;
  AddDeviceOptions("", &devices, &options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  devices.Check();
  Workspace workspace(arguments.workspace_path, arguments.options.input_type);
  workspace.UseMasks(arguments.options.mask_path);
  const FusedPixelEvaluation evaluation =
      RunInterruptibly([&](Progress& progress) {
        return EvaluateFusedPixels(
            workspace, arguments.options, fusion, devices, progress);
      });
  PrintEvaluation(ToJson(evaluation, arguments.options.tolerances),
                  arguments.json);
  return 0;
}

struct Form {
  const char* name;
  const char* summary;
  CommandFunction run;
};
constexpr Form kForms[] = {
    {"depth", "Depth maps, pixel by pixel", &EvaluateDepth},
    {"cloud", "A fused cloud, by the ETH3D measure", &EvaluateCloud},
    {"fused_pixels",
     "The pixels that become points, by the TSAR-MVS paper's measure",
     &RunEvaluateFusedPixels}};
constexpr const char* kSummary =
    "Scores a reconstruction against ground truth.";

void PrintForms() {
  std::cout << kSummary << "\n\nUsage:\n";
  for (const Form& form : kForms) {
    std::cout << "  tsar_evaluate " << form.name << " [options]  "
              << form.summary << "\n";
  }
  std::cout << "\ntsar_evaluate depth --help, and so on, explains the "
               "options.\n";
}

// Prints what --help_json prints elsewhere, with "forms" for options.
void PrintFormsJson() {
  Json json = {{"command", "tsar_evaluate"}, {"summary", kSummary}};
  for (const Form& form : kForms) {
    json["forms"].push_back({{"name", form.name}, {"summary", form.summary}});
  }
  std::cout << json.dump(2) << "\n";
}

}  // namespace

int RunTsarEvaluate(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  for (const Form& form : kForms) {
    if (what == form.name) {
      argv[1] = argv[0];
      return form.run(argc - 1, argv + 1);
    }
  }
  if (what == "-h" || what == "--help" || what == "--help_all") {
    PrintForms();
  } else if (what == "--help_json") {
    PrintFormsJson();
  } else {
    throw Error(ErrorCode::kBadOption,
                "tsar_evaluate: say what to evaluate, depth, cloud or "
                "fused_pixels; see tsar_evaluate --help");
  }
  return 0;
}

}  // namespace tsar
