// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/scene_model.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The Manhattan frame that some views' planes were aligned to.
struct FrameOfBlock {
  int component = 0;
  std::optional<Eigen::Matrix3d> rotation;
  // Per plane of the block, the column along which its normal lies, or -1; and
  // what was measured of it.
  std::vector<int> axes;
  std::vector<double> supports;
  // Which plane of the model it has become.
  std::vector<int> places;
};

// The frames of the whole scene. Those of blocks of one component that agree
// within 2 degrees, whatever their columns are called, become one: that of the
// block that measured most. A plane of the model lies along the axis that most
// of what was measured of it was aligned to, if it is still within 2 degrees of
// that. Sets the planes' frame and axis, and returns the frames, of which each
// has planes.
std::vector<Eigen::Matrix3d> FindSceneFrames(
    const std::vector<FrameOfBlock>& blocks, std::vector<ModelPlane>* planes);

}  // namespace tsar
