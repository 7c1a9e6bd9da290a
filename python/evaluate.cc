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

using py::literals::operator""_a;

py::dict EvaluateDepth(const std::filesystem::path& workspace_path,
                       const std::string& input_type,
                       const std::filesystem::path& ground_truth_path,
                       const std::filesystem::path& mask_path,
                       std::vector<double> tolerances) {
  DepthEvaluationOptions options;
  options.input_type = ToMapType(input_type);
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
    scores.append(py::dict("area"_a = score.area,
                           "tolerance"_a = score.tolerance,
                           "precision"_a = score.Precision(),
                           "recall"_a = score.Recall(),
                           "f1"_a = score.F1(),
                           "num_right"_a = score.num_right,
                           "num_estimated"_a = score.num_estimated,
                           "num_known"_a = score.num_known));
  }
  return py::dict(
      "num_images"_a = evaluation.num_images,
      "num_images_without_map"_a = evaluation.num_images_without_map,
      "num_masks"_a = evaluation.num_masks,
      "scores"_a = scores);
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
    scores.append(py::dict("tolerance"_a = score.tolerance,
                           "completeness"_a = score.completeness,
                           "accuracy"_a = score.accuracy,
                           "f1"_a = score.f1));
  }
  return py::dict("num_points"_a = evaluation.num_points,
                  "num_scan_points"_a = evaluation.num_scan_points,
                  "scores"_a = scores);
}

}  // namespace

void BindEvaluate(py::module_* module) {
  module->def("evaluate_depth", &EvaluateDepth);
  module->def("evaluate_cloud", &EvaluateCloudAgainstScans);
}

}  // namespace tsar
