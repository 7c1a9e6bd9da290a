// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_neighbours.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/controllers/neighbour_order.h"
#include "colmap_tsar/export/image_maps.h"
#include "colmap_tsar/workspace/patch_match_config.h"

#include <algorithm>
#include <cstddef>

namespace tsar {
namespace {

// Images whose points were triangulated by no angle say nothing of depth, but
// may see the same surface.
constexpr double kMinTriangulationAngle = 0.0;

// The images of the problems, the order of which keeps neighbours together,
// then all others.
std::vector<int> AllInOrder(const Workspace& workspace) {
  std::vector<int> order;
  std::vector<bool> is_there(workspace.Model().images.size(), false);
  const auto add = [&](int image) {
    if (!is_there[static_cast<size_t>(image)]) {
      is_there[static_cast<size_t>(image)] = true;
      order.push_back(image);
    }
  };
  for (const size_t problem : OrderByNeighbours(workspace)) {
    add(workspace.Problems()[problem].reference);
  }
  for (size_t image = 0; image < is_there.size(); ++image) {
    add(static_cast<int>(image));
  }
  return order;
}

}  // namespace

FusionPlan PlanFusion(const Workspace& workspace,
                      const ChosenImages& chosen,
                      int check_num_images) {
  const SparseModel& model = workspace.Model();
  std::vector<bool> has_maps(model.images.size(), false);
  for (const int image : FindImagesWithMaps(workspace)) {
    const auto i = static_cast<size_t>(image);
    has_maps[i] = chosen.used[i];
  }
  FusionPlan plan;
  plan.places.assign(model.images.size(), -1);
  for (const int image : AllInOrder(workspace)) {
    const auto i = static_cast<size_t>(image);
    if (has_maps[i] && chosen.fused[i]) {
      plan.places[i] = static_cast<int>(plan.order.size());
      plan.order.push_back(image);
    }
  }
  if (plan.order.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        "no image to fuse has " + ToString(workspace.Type()) +
            " depth and normal maps",
        "run patch_match_stereo or tsar_stereo on it first, or choose the "
        "other --input_type");
  }
  plan.matched.resize(model.images.size());
  for (const StereoProblem& problem : workspace.Problems()) {
    plan.matched[static_cast<size_t>(problem.reference)] = problem.sources;
  }
  const SourceSelector selector(model);
  plan.sources.resize(model.images.size());
  for (const int image : plan.order) {
    const auto i = static_cast<size_t>(image);
    std::vector<int>& sources = plan.sources[i];
    const auto add = [&](const std::vector<int>& others) {
      for (const int other : others) {
        if (other != image && has_maps[static_cast<size_t>(other)] &&
            static_cast<int>(sources.size()) < check_num_images &&
            std::find(sources.begin(), sources.end(), other) == sources.end()) {
          sources.push_back(other);
        }
      }
    };
    add(plan.matched[i]);
    add(selector.SelectSources(
        image, check_num_images, kMinTriangulationAngle));
  }
  return plan;
}

}  // namespace tsar
