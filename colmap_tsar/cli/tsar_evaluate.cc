// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/tools/evaluation/fused_pixel_evaluation.h"
#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"
#include "colmap_tsar/tools/evaluation/depth_evaluation.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

const char kHelp[] =
    "Scores a reconstruction against ground truth.\n\n"
    "Usage:\n"
    "  tsar_evaluate depth [options]  depth maps, pixel by pixel\n"
    "  tsar_evaluate cloud [options]  a fused cloud, by the ETH3D measure\n"
    "  tsar_evaluate fused_pixels [options]  pixels that become points\n\n"
    "tsar_evaluate depth --help, and so on, explains the options.\n";

// Prints what --help_json prints elsewhere, with "forms" for options.
void PrintFormsJson() {
  const Json json = {
      {"command", "tsar_evaluate"},
      {"summary", "Scores a reconstruction against ground truth."},
      {"forms",
       {{{"name", "depth"}, {"summary", "Depth maps, pixel by pixel"}},
        {{"name", "cloud"}, {"summary", "A fused cloud, by the ETH3D measure"}},
        {{"name", "fused_pixels"},
         {"summary",
          "The pixels that become points, by the TSAR-MVS paper's measure"}}}}};
  std::cout << json.dump(2) << "\n";
}

// Prints one row of a table; numbers are given as text.
void PrintRow(const std::vector<std::string>& cells) {
  for (size_t i = 0; i < cells.size(); ++i) {
    std::cout << (i == 0 ? std::left : std::right)
              << std::setw(i == 0 ? 12 : 13) << cells[i];
  }
  std::cout << "\n";
}

std::string Share(double value) {
  TextStream text;
  text << std::fixed << std::setprecision(4) << value;
  return text.str();
}

double ShareOf(int64_t part, int64_t all) {
  return static_cast<double>(part) /
         static_cast<double>(std::max<int64_t>(all, 1));
}

std::string Tolerance(double value) {
  TextStream text;
  text << value;
  return text.str();
}

void PrintJson(const DepthEvaluation& evaluation) {
  Json json;
  json["num_images"] = evaluation.num_images;
  json["num_images_without_map"] = evaluation.num_images_without_map;
  if (evaluation.num_masks) {
    json["num_masks"] = *evaluation.num_masks;
  }
  json["scores"] = Json::array();
  for (const DepthScore& score : evaluation.scores) {
    json["scores"].push_back({{"area", score.area},
                              {"tolerance", score.tolerance},
                              {"precision", score.Precision()},
                              {"recall", score.Recall()},
                              {"f1", score.F1()}});
  }
  std::cout << json.dump(2) << "\n";
}

void PrintTable(const DepthEvaluation& evaluation) {
  std::cout << evaluation.num_images << " images";
  if (evaluation.num_images_without_map > 0) {
    std::cout << " (" << evaluation.num_images_without_map
              << " more have ground truth but no map)";
  }
  if (evaluation.num_masks) {
    std::cout << ", masks for " << *evaluation.num_masks << " of them";
  }
  std::cout << "\n";
  PrintRow({"area", "tolerance", "precision", "recall", "F1"});
  for (const DepthScore& score : evaluation.scores) {
    PrintRow({score.area,
              Tolerance(score.tolerance),
              Share(score.Precision()),
              Share(score.Recall()),
              Share(score.F1())});
  }
}

void PrintJson(const CloudEvaluation& evaluation) {
  Json json;
  json["num_points"] = evaluation.num_points;
  json["num_scan_points"] = evaluation.num_scan_points;
  json["scores"] = Json::array();
  for (const CloudScore& score : evaluation.scores) {
    json["scores"].push_back({{"tolerance", score.tolerance},
                              {"completeness", score.completeness},
                              {"accuracy", score.accuracy},
                              {"f1", score.f1}});
  }
  std::cout << json.dump(2) << "\n";
}

void PrintTable(const CloudEvaluation& evaluation) {
  std::cout << evaluation.num_points << " points, "
            << evaluation.num_scan_points << " scan points\n";
  PrintRow({"tolerance", "completeness", "accuracy", "F1"});
  for (const CloudScore& score : evaluation.scores) {
    PrintRow({Tolerance(score.tolerance),
              Share(score.completeness),
              Share(score.accuracy),
              Share(score.f1)});
  }
}

int EvaluateDepth(int argc, char** argv) {
  DepthEvaluationOptions evaluation_options;
  std::string workspace_path;
  std::string ground_truth_path;
  std::string mask_path;
  std::string tolerances = "0.02,0.1";
  bool json = false;
  OptionSet options(
      "tsar_evaluate depth",
      "Compares the depth maps of a COLMAP dense workspace with ground truth "
      "depth. Precision is the share of right depths among the estimated ones, "
      "recall the share of right depths among all pixels with ground truth, F1 "
      "their harmonic mean; each for all pixels and for textureless areas, "
      "where gray values vary by less than 4 of 255 levels (standard deviation "
      "in a window of 11 x 11 pixels).",
      "tsar_evaluate depth --workspace_path dense --tolerances 0.02,0.1");
  options.AddRequired("workspace_path",
                      &workspace_path,
                      "Folder of the dense workspace; its images are needed to "
                      "find the textureless areas.");
  options.AddChoice("input_type",
                    &evaluation_options.input_type,
                    {"geometric", "photometric"},
                    "Which of the depth maps to score.");
  options.Add("ground_truth_path",
              &ground_truth_path,
              "Folder with IMAGE_NAME.bin, depth maps in COLMAP's format, 0 = "
              "unknown. If empty, ground_truth/depth in the workspace.");
  options.Add("mask_path",
              &mask_path,
              "The folder with masks of the undistorted images, named as for "
              "COLMAP: a.jpg.png for a.jpg. Pixels where a mask is black (0) "
              "are not scored.");
  options.Add("tolerances",
              &tolerances,
              "A depth is right if it is off by less than this; rising numbers "
              "with commas, in units of the model (meters, if it has them).");
  options.Add("json", &json, "Print JSON instead of a table.");
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  evaluation_options.ground_truth_path = ground_truth_path;
  evaluation_options.mask_path = mask_path;
  evaluation_options.tolerances = ParseTolerances(tolerances);
  const DepthEvaluation evaluation =
      EvaluateDepthMaps(workspace_path, evaluation_options);
  json ? PrintJson(evaluation) : PrintTable(evaluation);
  return 0;
}

// Masks apply to images, but a user may give them for a point cloud.
void RequireNoMasks(int argc, char** argv) {
  if (std::any_of(argv, argv + argc, [](const std::string& argument) {
        return argument == "--mask_path" ||
               argument.starts_with("--mask_path=");
      })) {
    throw Error(ErrorCode::kBadOption,
                "--mask_path: masks are of images, and a cloud is scored as a "
                "whole; leave it out, or see tsar_evaluate depth --help");
  }
}

int EvaluateCloud(int argc, char** argv) {
  RequireNoMasks(argc, argv);
  CloudEvaluationOptions evaluation_options;
  std::string input_path;
  std::string ground_truth_path;
  std::string tolerances = "0.01,0.02,0.05,0.1";
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
  options.Add("tolerances",
              &tolerances,
              "Distances up to which a point is right; rising numbers with "
              "commas, in units of the scans (meters, if they have them).");
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
  evaluation_options.tolerances = ParseTolerances(tolerances);
  const CloudEvaluation evaluation =
      EvaluateCloudFile(input_path, ground_truth_path, evaluation_options);
  json ? PrintJson(evaluation) : PrintTable(evaluation);
  return 0;
}

void PrintJson(const FusedPixelEvaluation& evaluation,
               const std::vector<double>& tolerances) {
  Json json;
  json["num_images"] = evaluation.num_images;
  json["num_known"] = evaluation.num_known;
  json["num_fused"] = evaluation.num_fused;
  json["scores"] = Json::array();
  for (size_t t = 0; t < tolerances.size(); ++t) {
    json["scores"].push_back(
        {{"tolerance", tolerances[t]},
         {"right", ShareOf(evaluation.num_right[t], evaluation.num_fused)}});
  }
  std::cout << json.dump(2) << "\n";
}

void PrintTable(const FusedPixelEvaluation& evaluation,
                const std::vector<double>& tolerances) {
  std::cout << evaluation.num_images << " images, " << evaluation.num_fused
            << " of " << evaluation.num_known
            << " pixels with ground truth became a point\n";
  PrintRow({"tolerance", "right"});
  for (size_t t = 0; t < tolerances.size(); ++t) {
    PrintRow({Tolerance(tolerances[t]),
              Share(ShareOf(evaluation.num_right[t], evaluation.num_fused))});
  }
}

int RunEvaluateFusedPixels(int argc, char** argv) {
  FusedPixelOptions evaluation_options;
  std::string workspace_path;
  std::string input_type = ToString(MapType::kGeometric);
  std::string ground_truth_path;
  std::string mask_path;
  std::string tolerances = "0.02,0.1";
  bool json = false;
  DeviceArguments devices;
  OptionSet options(
      "tsar_evaluate fused_pixels",
      "Fuses the maps of a dense workspace by the thresholds of the TSAR-MVS "
      "paper and compares, of each point, the pixel that became the point with "
      "ground truth depth, as in the paper's ablation. It tells how good the "
      "depths are that reach the cloud, each surface once, however many images "
      "see it. Shares are of these pixels; what those of the paper are of is "
      "not printed there.",
      "tsar_evaluate fused_pixels --workspace_path dense");
  options.AddRequired("workspace_path",
                      &workspace_path,
                      "Folder of the dense workspace, refined or not.");
  AddMapType("input_type", &input_type, "Which of the maps to fuse.", &options);
  options.Add("ground_truth_path",
              &ground_truth_path,
              "Folder with IMAGE_NAME.bin, depth maps in COLMAP's format, 0 = "
              "unknown. If empty, ground_truth/depth "
              "in the workspace.");
  options.Add("mask_path",
              &mask_path,
              "The folder with masks of the undistorted images, named as for "
              "COLMAP: a.jpg.png for a.jpg. Where a mask is black (0), depths "
              "count as missing.");
  options.Add("tolerances",
              &tolerances,
              "A depth is right if it is off by less than this; rising numbers "
              "with commas, in units of the model (meters, if it has them).");
  options.Add("json", &json, "Print JSON instead of a table.");
  AddDeviceArguments("", &devices, &options);
  options.Add("num_threads",
              &devices.num_threads,
              "Number of CPU threads; -1: one for each core.",
              {-1, 4096});
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  evaluation_options.ground_truth_path = ground_truth_path;
  evaluation_options.tolerances = ParseTolerances(tolerances);
  evaluation_options.devices = devices.Parse();
  Workspace workspace(workspace_path, *ParseMapType(input_type));
  workspace.UseMasks(mask_path);
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  const FusedPixelEvaluation evaluation =
      EvaluateFusedPixels(workspace, evaluation_options, progress, [&] {
        return interruption.Requested();
      });
  json ? PrintJson(evaluation, evaluation_options.tolerances)
       : PrintTable(evaluation, evaluation_options.tolerances);
  return 0;
}

}  // namespace

int RunTsarEvaluate(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const std::map<std::string, CommandFunction> forms = {
      {"depth", &EvaluateDepth},
      {"cloud", &EvaluateCloud},
      {"fused_pixels", &RunEvaluateFusedPixels}};
  if (const auto form = forms.find(what); form != forms.end()) {
    argv[1] = argv[0];
    return form->second(argc - 1, argv + 1);
  }
  if (what == "-h" || what == "--help") {
    std::cout << kHelp;
    return 0;
  }
  if (what == "--help_json") {
    PrintFormsJson();
    return 0;
  }
  throw Error(ErrorCode::kBadOption,
              "tsar_evaluate: say what to evaluate, depth, cloud or "
              "fused_pixels; see "
              "tsar_evaluate --help");
}

}  // namespace tsar
