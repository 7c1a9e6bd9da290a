// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <Eigen/SparseCore>

namespace tsar {

// The entries of a sparse matrix's inverse where the matrix itself has entries,
// without the rest of the inverse, which is dense: those of a covariance where
// the matrix holds information. Takes as long as a few factorisations. The
// matrix must be symmetric and positive definite, with both of its triangles;
// throws std::invalid_argument where it is not positive definite.
Eigen::SparseMatrix<double> SelectedInverse(
    const Eigen::SparseMatrix<double>& matrix);

}  // namespace tsar
