// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/score_planes.h"
#include "colmap_tsar/scene/evidence/superpixel_matches.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

namespace tsar {

// The largest distance of planes that are merged, in tolerances, where each of
// them was measured.
inline constexpr double kMaxMergeDistance = 10.0;

// Whether the angle between the planes allows a merge.
bool MayBeMerged(const WorldPlane& a, const WorldPlane& b);

// Drops planes and replaces pairs by a joint fit as long as some change loses
// less score than its limit; the one with the smallest ratio of loss to limit
// comes first. The limit for dropping a plane is min_gain; the loss of each
// superpixel is weighted by the share of the views that assign its matches to
// the plane, too. The limit for merging two is min_gain or, if larger, the
// support of the smaller one times the square of its confusion with the larger
// one: the share of other views that assign the matches of its superpixels to
// that one; squared, since two views must confuse them. Returns whether there
// was any change, which does not depend on the threads.
bool DropAndMergePlanes(const PlaneScorer& scorer,
                        const SuperpixelMatches& matches,
                        double min_gain,
                        std::vector<ScoredPlane>* planes);

}  // namespace tsar
