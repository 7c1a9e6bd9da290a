// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_neighbors.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/source_selector.h"
#include "colmap_tsar/run/neighbor_order.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <algorithm>
#include <cstddef>

namespace tsar {
namespace {

// No limit, as in COLMAP's fusion, which uses any image that shares points.
constexpr double kMinTriangulationAngle = 0.0;

// The references, in an order that keeps neighbors together, then all other
// images.
std::vector<int> AllInOrder(const Workspace& workspace) {
  std::vector<int> order;
  std::vector<bool> is_there(workspace.Model().images.size(), false);
  const auto add = [&](int image) {
    if (!is_there[image]) {
      is_there[image] = true;
      order.push_back(image);
    }
  };
  for (const size_t problem : OrderByNeighbors(workspace)) {
    add(workspace.Problems()[problem].reference);
  }
  for (size_t image = 0; image < is_there.size(); ++image) {
    add(static_cast<int>(image));
  }
  return order;
}

// Whether each image of the sparse model is in the list; all are where its path
// is empty.
std::vector<bool> ReadListed(const Workspace& workspace,
                             const std::filesystem::path& list,
                             const std::string& option) {
  std::vector<bool> listed(workspace.Model().images.size(), list.empty());
  if (!list.empty()) {
    for (const ListedImage& image :
         ReadImageList(list, workspace.Model(), option)) {
      listed[image.image] = true;
    }
  }
  return listed;
}

// By image of the sparse model: those with maps that COLMAP's configuration
// lists, if there is one.
std::vector<bool> FindUsable(const Workspace& workspace) {
  const std::filesystem::path config =
      workspace.Root() / "stereo" / "fusion.cfg";
  const std::vector<bool> is_configured =
      ReadListed(workspace,
                 Exists(config) ? config : std::filesystem::path(),
                 "fusion.cfg");
  std::vector<bool> is_usable(is_configured.size(), false);
  for (const int image : FindImagesWithMaps(workspace)) {
    const auto i = static_cast<size_t>(image);
    is_usable[i] = is_configured[i];
  }
  return is_usable;
}

}  // namespace

FusionPlan PlanFusion(const Workspace& workspace,
                      const std::filesystem::path& image_list_path,
                      int check_num_images) {
  const SparseModel& model = workspace.Model();
  const std::vector<bool> is_usable = FindUsable(workspace);
  const std::vector<bool> is_listed =
      ReadListed(workspace, image_list_path, OptionName("image_list_path"));
  FusionPlan plan;
  plan.places.assign(model.images.size(), -1);
  for (const int image : AllInOrder(workspace)) {
    const auto i = static_cast<size_t>(image);
    if (is_usable[i] && is_listed[i]) {
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
        "run patch_match_stereo or tsar_stereo on it first, see which images "
        "stereo/fusion.cfg and the image list name, or " +
            AdviceOfTypes(workspace.Root()));
  }
  std::vector<std::vector<int>> matched(model.images.size());
  for (const StereoProblem& problem : workspace.Problems()) {
    matched[problem.reference] = problem.sources;
  }
  const SourceSelector selector(model, kMinTriangulationAngle);
  plan.sources.resize(model.images.size());
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (!is_usable[i]) {
      continue;
    }
    const auto image = static_cast<int>(i);
    std::vector<int>& sources = plan.sources[i];
    const auto add = [&](const std::vector<int>& others) {
      for (const int other : others) {
        if (other != image && is_usable[other] &&
            static_cast<int>(sources.size()) < check_num_images &&
            std::find(sources.begin(), sources.end(), other) == sources.end()) {
          sources.push_back(other);
        }
      }
    };
    add(selector.SelectSources(image, check_num_images));
    add(matched[i]);
  }
  return plan;
}

}  // namespace tsar
