// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/join_planes.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A plane with its observations.
struct MeasuredPlane {
  WorldPlane plane;
  double support = 0.0;  // See ScenePlane::support.
  FitSamples samples;    // Its observations.
};

// Three orthogonal directions.
struct ManhattanFrame {
  Eigen::Matrix3d rotation;  // Its columns are the directions.
  // Per plane, the column along which its normal lies exactly, or -1.
  std::vector<int> axes;
};

// Finds the three orthogonal directions along which planes have most support,
// fits them and the planes within 5 degrees of them to the samples of all these
// planes at once, and gives each of these planes exactly its direction: a wall
// that only a band of posters measures may lean by a degree and still fit its
// observations. Other planes that are orthogonal to a direction within 5
// degrees, such as a pillar's faces, become exactly orthogonal.
//
// loss_scale: see FitPlane. is_acceptable(p, plane): whether this plane may
// replace planes[p]; otherwise that one stays, and the directions are fitted
// without it. Planes without samples rotate about their point nearest to the
// origin. Returns a plane for each of `planes`, in their order; they are all
// unchanged where no two with a support are orthogonal to within 10 degrees.
// frame_found: where not null, receives the directions, or nothing where planes
// are unchanged.
std::vector<WorldPlane> AlignToManhattanFrame(
    const std::vector<MeasuredPlane>& planes,
    double loss_scale,
    const std::function<bool(int p, const WorldPlane& plane)>& is_acceptable,
    std::optional<ManhattanFrame>* frame_found = nullptr);

// The frames of the whole scene. Frames of blocks of one component that agree
// within 2 degrees, up to order and sign of columns, become one: that of the
// block with the largest support. A plane of the model lies along the axis to
// which most of its support was aligned, if it is still within 2 degrees of
// that. Sets the planes' frame and axis, and returns the frames, of which each
// has planes. indices: see JoinedPlanes.
std::vector<Eigen::Matrix3d> FindSceneFrames(
    const std::vector<PlaneBlock>& blocks,
    const std::vector<std::vector<int>>& indices,
    std::vector<ModelPlane>* planes);

}  // namespace tsar
