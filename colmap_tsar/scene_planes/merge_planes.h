// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/plane_scores.h"
#include "colmap_tsar/scene_planes/superpixel_plane_fitter.h"

#include <vector>

namespace tsar {

// Planes are not merged that are further apart, in tolerances, where each of
// them was measured.
inline constexpr double kMaxMergeDistance = 10.0;

// That many joint fits, of which a pair has two, are scored at a time at most.
inline constexpr int kMaxJointFits = 64;

// What merging two planes may cost of their supports together.
double MaxMergeLoss(double min_gain, double support_a, double support_b);

// Whether their directions are close enough at all.
bool MayBeMerged(const WorldPlane& a, const WorldPlane& b);

// Drops planes, which may cost min_gain each, and replaces pairs by a joint
// fit, which may cost MaxMergeLoss(), as long as there is such a change; the
// one that costs the smallest share of what it may comes first. Returns whether
// there was any, which does not depend on the threads.
bool DropAndMergePlanes(const SuperpixelPlaneFitter& fitter,
                        double min_gain,
                        ThreadPool& threads,
                        std::vector<ScoredPlane>* planes);

}  // namespace tsar
