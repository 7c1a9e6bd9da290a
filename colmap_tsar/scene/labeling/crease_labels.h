// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"

#include <vector>

namespace tsar {

// The costs of a view's labels where planes end at creases.
class CreaseLabels {
 public:
  // creases: of planes that the view may be labeled with. Keeps references to
  // all but the view's camera.
  CreaseLabels(const ObservedView& view,
               const std::vector<ModelPlane>& planes,
               const std::vector<BoundingCrease>& creases);

  // Adds costs of superpixels (row) beyond a crease on planes (column; indices:
  // in the model): on the plane that ends there, and on others without
  // evidence, except those that begin at another crease in front of the plane
  // that begins here. On planes that begin here, the costs for missing
  // measurements are removed, and other superpixels are excluded. votes: of the
  // size of the costs, or empty.
  void AddVotes(const std::vector<int>& indices,
                const Image<PlaneCost>& costs,
                const LabelOptions& options,
                Image<float>* votes) const;

 private:
  const ViewEvidence& evidence_;
  const Camera camera_;
  const std::vector<ModelPlane>& planes_;
  const std::vector<BoundingCrease>& creases_;
  std::vector<Vec3f> rays_;        // The center of each superpixel,
  std::vector<float> num_pixels_;  // and its size.
  // By crease and superpixel: where it lies beyond, the depth of the plane that
  // begins there; 0 elsewhere.
  std::vector<std::vector<float>> limits_;
};

}  // namespace tsar
