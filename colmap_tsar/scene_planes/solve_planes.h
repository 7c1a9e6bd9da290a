// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/plane_parameters.h"
#include "colmap_tsar/scene_planes/plane_residuals.h"

#include <memory>
#include <vector>

#include <Eigen/SparseCore>

namespace tsar {

// What planes are adjusted to. Lengths have to be about 1, and to be about the
// origin: a pull to where planes are, of a standard deviation of 32 lengths and
// radians, makes the problem definite and takes nothing from what is known.
using PlaneResiduals = std::vector<std::unique_ptr<PlaneResidual>>;

// The numbers of `parameters`, from 0 on, that agree best with the residuals; 0
// where no better ones were found.
std::vector<double> SolvePlanes(const PlaneParameters& parameters,
                                const PlaneResiduals& residuals,
                                double loss_scale);

// The inverse of the covariance of these numbers where they are 0.
Eigen::SparseMatrix<double> PlaneInformation(const PlaneParameters& parameters,
                                             const PlaneResiduals& residuals,
                                             double loss_scale);

}  // namespace tsar
