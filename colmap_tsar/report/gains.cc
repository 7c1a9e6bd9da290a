// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/gains.h"

#include "colmap_tsar/store/originals.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <string>

namespace tsar {

Gain<DepthEvaluation> EvaluateDepthGain(
    const Workspace& workspace,
    const std::filesystem::path& ground_truth_path,
    const std::vector<double>& tolerances) {
  DepthEvaluationOptions options;
  options.input_type = ToString(workspace.Type());
  options.ground_truth_path = ground_truth_path;
  options.tolerances = tolerances;
  Gain<DepthEvaluation> gain;
  gain.after = EvaluateDepthMaps(workspace.Root(), options);
  options.find_map = [&](const std::string& name) {
    const int image = workspace.Model().IndexOf(name);
    const MapType type = workspace.Type();
    return image < 0 ? GetMapPaths(workspace.Root(), name, type).depth
                     : FindOriginals(workspace.SourcePaths(image, type)).depth;
  };
  gain.before = EvaluateDepthMaps(workspace.Root(), options);
  return gain;
}

Gain<CloudEvaluation> EvaluateCloudGain(
    const std::filesystem::path& before_path,
    const std::filesystem::path& after_path,
    const std::filesystem::path& scans_path,
    const std::vector<double>& tolerances) {
  CloudEvaluationOptions options;
  options.tolerances = tolerances;
  return {EvaluateCloudFile(before_path, scans_path, options),
          EvaluateCloudFile(after_path, scans_path, options)};
}

}  // namespace tsar
