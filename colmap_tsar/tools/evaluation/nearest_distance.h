// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <Eigen/Core>

namespace tsar {

// Before anything is read for them: throws Error kUnsupported where this program
// was built without them (TSAR_CLOUD_EVALUATION).
void RequireNearestDistances();

// For each query the distance to its nearest target, exactly, or infinity where
// no target lies within max_distance. Works on all CPU cores. Errors as
// RequireNearestDistances().
std::vector<double> NearestDistances(
    const std::vector<Eigen::Vector3d>& queries,
    const std::vector<Eigen::Vector3d>& targets,
    double max_distance);

}  // namespace tsar
