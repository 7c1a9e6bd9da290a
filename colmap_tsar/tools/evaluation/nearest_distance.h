// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <Eigen/Core>

namespace tsar {

// Throws Error kUnsupported if the program was built without nearest distances
// (TSAR_CLOUD_EVALUATION). To be called before inputs are read.
void RequireNearestDistances();

// The exact distance of each query to its nearest target; infinity beyond
// max_distance. Uses all CPU cores. Errors as RequireNearestDistances().
std::vector<double> NearestDistances(
    const std::vector<Eigen::Vector3d>& queries,
    const std::vector<Eigen::Vector3d>& targets,
    double max_distance);

}  // namespace tsar
