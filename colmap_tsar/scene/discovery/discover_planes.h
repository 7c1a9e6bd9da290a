// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The candidates of all views, those of the first one first.
std::vector<WorldPlane> CollectCandidates(
    const std::vector<ObservedView>& views);

struct DiscoverPlanesOptions {
  // How far a depth may be off a plane to speak for it at all, in relative
  // depths of one pixel of disparity (DepthResolution::RelativeDepthError).
  double tolerance = 1.0;
  // A superpixel counts for this many pixels of full confidence at most, so
  // that the size of superpixels and of the raster decide little.
  double max_weight = 40.0;
  // What a plane must add to be worth having, in pixels of full confidence that
  // lie right on it.
  double min_gain = 100.0;
  int max_planes = 40;
  // Whether planes become exactly parallel or orthogonal to each other where
  // that agrees with the observations.
  bool manhattan_frame = true;
  // How many scores of a candidate for a superpixel are held at a time, in four
  // bytes each.
  size_t max_scores = size_t{1} << 25;
};

struct ScenePlane {
  WorldPlane plane;
  // Sum of the scores of the superpixels that are assigned to it.
  double support = 0.0;
  // Of the Manhattan frame, the column along which its normal lies exactly; -1:
  // of none.
  int axis = -1;
};

struct DiscoveredPlanes {
  // By falling support; those that priors alone tell of come last.
  std::vector<ScenePlane> planes;
  // assignment[view][superpixel] is the index of the plane that explains the
  // superpixel's observations best, or -1 where none explains any.
  std::vector<std::vector<int>> assignment;
  // A rotation whose columns are the axes, in the world frame, where planes
  // were aligned to one.
  std::optional<Eigen::Matrix3d> frame;
};

// The few planes that together explain best what a view and its neighbours
// measured, from many candidates in the world frame: facility location, where a
// plane costs min_gain and is assigned superpixels. A plane's score for a
// superpixel is the sum over its observations of 1 - (residual / tolerance)^2,
// never below 0, times the confidences, scaled to a sum of the superpixel's
// weight or max_weight, whichever is less. The residual is NormalizedResidual
// with one pixel of disparity as the expected error.
//
// Greedy choice of candidates, while one adds min_gain as it is, is followed by
// rounds in which each plane is fitted to the superpixels assigned to it, in
// all views at once, and in which planes are dropped that are not worth
// min_gain, and merged that views take for each other (DropAndMergePlanes). At
// last planes are aligned (AlignToManhattanFrame) that lose little by that,
// and each superpixel is assigned to the plane with the highest score.
//
// Where candidates times superpixels are more than max_scores, the last of the
// candidates are left out: list the likely ones first.
//
// The first view is the reference: arithmetic is done in its camera's frame, so
// that the world's origin may be far away. Otherwise the order of the views
// matters only by rounding, by which observations are in the sample that a fit
// to very many of them uses, and by which one of a superpixel is matched. Equal
// candidates: the first wins. Equal scores: the superpixel goes to the plane
// that was found first. Bits do not depend on the device or on the number of
// threads.
DiscoveredPlanes DiscoverPlanes(const std::vector<ObservedView>& views,
                                const std::vector<WorldPlane>& candidates,
                                const DiscoverPlanesOptions& options,
                                Device& device);

}  // namespace tsar
