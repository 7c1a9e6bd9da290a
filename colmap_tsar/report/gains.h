// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/evaluation/cloud_evaluation.h"
#include "colmap_tsar/evaluation/depth_evaluation.h"
#include "colmap_tsar/store/workspace.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace tsar {

// The same measure before and after.
template <typename Evaluation>
struct Gain {
  Evaluation before;
  Evaluation after;
};

// What refinement brought, against ground truth.
struct Gains {
  std::optional<Gain<DepthEvaluation>> depth;
  std::optional<Gain<CloudEvaluation>> clouds;
};

// Scores the maps of the workspace's type, the originals and those in place.
// ground_truth_path: see DepthEvaluationOptions; not empty. Throws what
// EvaluateDepthMaps and FindOriginals throw.
Gain<DepthEvaluation> EvaluateDepthGain(
    const Workspace& workspace,
    const std::filesystem::path& ground_truth_path,
    const std::vector<double>& tolerances);

// Scores two clouds. Throws what EvaluateCloudFile throws.
Gain<CloudEvaluation> EvaluateCloudGain(
    const std::filesystem::path& before_path,
    const std::filesystem::path& after_path,
    const std::filesystem::path& scans_path,
    const std::vector<double>& tolerances);

}  // namespace tsar
