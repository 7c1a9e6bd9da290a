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

// What a view is labelled with where planes end at creases.
class CreaseLabels {
 public:
  // creases: those of planes that the view may be labelled with. Keeps
  // references to all but the view's camera.
  CreaseLabels(const ObservedView& view,
               const std::vector<ModelPlane>& planes,
               const std::vector<BoundingCrease>& creases);

  // Adds to the costs of superpixels (row) on planes (column; numbers: in the
  // model) that lie beyond a crease: of the plane that ends there, and of
  // others that nothing speaks for, but for those that begin at another crease
  // and stand before the one that begins here. Those that begin here lose what
  // it costs them that nothing of them was measured, and cannot be elsewhere.
  // votes: of the size of the costs, or empty.
  void AddVotes(const std::vector<int>& numbers,
                const Image<PlaneCost>& costs,
                const LabelOptions& options,
                Image<float>* votes) const;

 private:
  const ViewEvidence& evidence_;
  const Camera camera_;
  const std::vector<ModelPlane>& planes_;
  const std::vector<BoundingCrease>& creases_;
  std::vector<Vec3f> rays_;        // The middle of each superpixel,
  std::vector<float> num_pixels_;  // and its size.
  // By crease and superpixel, where it lies beyond, the depth at which the
  // plane begins; 0 elsewhere.
  std::vector<std::vector<float>> limits_;
};

}  // namespace tsar
