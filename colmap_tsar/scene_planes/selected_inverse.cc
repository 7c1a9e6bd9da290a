// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/selected_inverse.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>

namespace tsar {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

// Where an entry of the lower triangle, which has to be stored, lies among the
// values of a matrix whose columns are sorted.
Eigen::Index Find(const Matrix& matrix, int a, int b) {
  const auto [col, row] = std::minmax(a, b);
  const int* begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[col];
  const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[col + 1];
  return std::lower_bound(begin, end, row) - matrix.innerIndexPtr();
}

}  // namespace

// By Takahashi's recursion: with P A P^T = L D L^T the inverse Z of that is
// D^-1 L^-1 + (I - L^T) Z, in which an entry where L has one needs only others
// of that kind, to the right of it.
Matrix SelectedInverse(const Matrix& matrix) {
  if (matrix.rows() == 0) {
    return matrix;
  }
  const Eigen::SimplicialLDLT<Matrix> solver(matrix);
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) {
    throw std::invalid_argument(
        "SelectedInverse: the matrix is not positive definite");
  }
  const int size = static_cast<int>(matrix.rows());
  const Matrix lower = solver.matrixL().nestedExpression();
  const Eigen::VectorXd diagonal = solver.vectorD();
  // Of the inverse: below its diagonal, at the places of `lower`; and on it.
  std::vector<double> below(lower.nonZeros());
  Eigen::VectorXd on(size);
  const int* rows = lower.innerIndexPtr();
  const double* values = lower.valuePtr();
  for (int col = size - 1; col >= 0; --col) {
    const int begin = lower.outerIndexPtr()[col];
    const int end = lower.outerIndexPtr()[col + 1];
    for (int i = begin; i < end; ++i) {
      double sum = 0.0;
      for (int k = begin; k < end; ++k) {
        sum -= values[k] *
               (k == i ? on[rows[i]] : below[Find(lower, rows[k], rows[i])]);
      }
      below[i] = sum;
    }
    double sum = 1.0 / diagonal[col];
    for (int k = begin; k < end; ++k) {
      sum -= values[k] * below[k];
    }
    on[col] = sum;
  }
  Matrix inverse = matrix;
  const auto& order = solver.permutationP().indices();
  for (int col = 0; col < size; ++col) {
    for (Matrix::InnerIterator entry(inverse, col); entry; ++entry) {
      const int a = order[entry.row()];
      const int b = order[col];
      entry.valueRef() = a == b ? on[a] : below[Find(lower, a, b)];
    }
  }
  return inverse;
}

}  // namespace tsar
