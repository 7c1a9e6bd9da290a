// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"
#include "colmap_tsar/tools/evaluation/depth_evaluation.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "python/bindings.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

py::dict EvaluateDepth(const std::filesystem::path& workspace_path,
                       const std::string& input_type,
                       const std::filesystem::path& ground_truth_path,
                       const std::filesystem::path& mask_path,
                       std::vector<double> tolerances) {
  DepthEvaluationOptions options;
  options.input_type = ToString(ToMapType(input_type));
  options.ground_truth_path = ground_truth_path;
  options.mask_path = mask_path;
  options.tolerances = std::move(tolerances);
  DepthEvaluation evaluation;
  {
    const py::gil_scoped_release release;
    evaluation = EvaluateDepthMaps(workspace_path, options);
  }
  py::list scores;
  for (const DepthScore& score : evaluation.scores) {
    py::dict dict;
    dict["area"] = score.area;
    dict["tolerance"] = score.tolerance;
    dict["precision"] = score.Precision();
    dict["recall"] = score.Recall();
    dict["f1"] = score.F1();
    dict["num_right"] = score.num_right;
    dict["num_estimated"] = score.num_estimated;
    dict["num_known"] = score.num_known;
    scores.append(dict);
  }
  py::dict dict;
  dict["num_images"] = evaluation.num_images;
  dict["num_images_without_map"] = evaluation.num_images_without_map;
  dict["num_masks"] = evaluation.num_masks;
  dict["scores"] = scores;
  return dict;
}

py::dict EvaluateCloudAgainstScans(const std::filesystem::path& cloud_path,
                                   const std::filesystem::path& scans_path,
                                   std::vector<double> tolerances,
                                   double voxel_size,
                                   double beam_radius,
                                   double beam_angle) {
  CloudEvaluationOptions options;
  options.tolerances = std::move(tolerances);
  options.voxel_size = voxel_size;
  options.beam.start_radius = beam_radius;
  options.beam.divergence_degrees = beam_angle;
  CloudEvaluation evaluation;
  {
    const py::gil_scoped_release release;
    evaluation = EvaluateCloudFile(cloud_path, scans_path, options);
  }
  py::list scores;
  for (const CloudScore& score : evaluation.scores) {
    py::dict dict;
    dict["tolerance"] = score.tolerance;
    dict["completeness"] = score.completeness;
    dict["accuracy"] = score.accuracy;
    dict["f1"] = score.f1;
    scores.append(dict);
  }
  py::dict dict;
  dict["num_points"] = evaluation.num_points;
  dict["num_scan_points"] = evaluation.num_scan_points;
  dict["scores"] = scores;
  return dict;
}

}  // namespace

void BindEvaluate(py::module_* module) {
  module->def("evaluate_depth", &EvaluateDepth);
  module->def("evaluate_cloud", &EvaluateCloudAgainstScans);
}

}  // namespace tsar
