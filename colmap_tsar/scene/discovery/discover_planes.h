// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The candidate planes of all views, in the order of the views.
std::vector<WorldPlane> CollectCandidates(
    const std::vector<ObservedView>& views);

// The largest weight of a superpixel, in pixels of full confidence, so that the
// sizes of superpixels and of the raster matter little. This many pixels count
// as one measurement, since errors of neighbors are correlated.
inline constexpr double kMaxSuperpixelWeight = 40.0;

// The expected error of one observation, as a share of the tolerance.
inline constexpr double kErrorShare = 0.25;

struct DiscoverPlanesOptions {
  // The residual from which on a depth is an outlier of a plane, in relative
  // depths of one pixel of disparity (DepthResolution::RelativeDepthError).
  double tolerance = 1.0;
  // The least gain of a plane, in pixels of full confidence that lie exactly on
  // it.
  double min_gain = 100.0;
  int max_planes = 40;
  // Whether planes are made exactly parallel or orthogonal to each other where
  // the observations allow it.
  bool manhattan_frame = true;
  // The largest number of scores in memory, one per candidate and superpixel.
  size_t max_scores = size_t{1} << 25;
};

struct ScenePlane {
  WorldPlane plane;
  // Sum of the scores of the superpixels that are assigned to it.
  double support = 0.0;
  // The column of the Manhattan frame along which its normal lies, or -1.
  int axis = -1;
};

struct DiscoveredPlanes {
  // By decreasing support; planes that only depth priors observe come last.
  std::vector<ScenePlane> planes;
  // assignment[view][superpixel] is the index of the plane that explains the
  // superpixel's observations best, or -1 where none explains any.
  std::vector<std::vector<int>> assignment;
  // A rotation whose columns are the axes, in the world frame, where planes
  // were aligned to one.
  std::optional<Eigen::Matrix3d> frame;
};

// Selects, from many candidates in the world frame, the few planes that
// together best explain the observations of a view and its neighbors: facility
// location, where a plane costs min_gain and is assigned superpixels. A plane's
// score for a superpixel is the sum over its observations of 1 - (residual /
// tolerance)^2, never below 0, times the confidences, scaled to a sum of the
// superpixel's weight or kMaxSuperpixelWeight, whichever is less. The residual
// is NormalizedResidual with one pixel of disparity as the expected error.
//
// Candidates are chosen greedily while one adds min_gain. Then, in rounds, each
// plane is fitted to the superpixels assigned to it in all views, planes with a
// gain below min_gain are dropped, and planes that views confuse are merged
// (DropAndMergePlanes). Finally, planes that lose little by it are aligned
// (AlignToManhattanFrame), and each superpixel is assigned to the plane with
// the highest score, or to the one found first of several.
//
// Where candidates times superpixels exceed max_scores, the last candidates are
// left out. Arithmetic is done in the frame of the first camera, so that the
// world's origin may be far away; otherwise the order of the views matters only
// by rounding and by which observation of a superpixel is matched. Bits depend
// neither on the device nor on the number of threads.
DiscoveredPlanes DiscoverPlanes(const std::vector<ObservedView>& views,
                                const std::vector<WorldPlane>& candidates,
                                const DiscoverPlanesOptions& options,
                                Device& device);

}  // namespace tsar
