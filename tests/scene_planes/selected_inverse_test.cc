// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/selected_inverse.h"

#include "colmap_tsar/base/random.h"

#include <stdexcept>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Positive definite, with drawn couplings.
Eigen::SparseMatrix<double> Draw(int size, int num_couplings) {
  Philox random(size, num_couplings, 0);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  for (int i = 0; i < num_couplings; ++i) {
    const int a = random.NextBelow(size);
    const int b = random.NextBelow(size);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    row[a] += random.NextFloat() - 0.5;
    row[b] += random.NextFloat() - 0.5;
    matrix += 10.0 * row * row.transpose();
  }
  return matrix.sparseView();
}

TEST(SelectedInverse, AgreesWithTheInverse) {
  for (const int num_couplings : {0, 10, 40, 200}) {
    const Eigen::SparseMatrix<double> matrix = Draw(40, num_couplings);
    const Eigen::SparseMatrix<double> selected = SelectedInverse(matrix);
    const Eigen::MatrixXd inverse = Eigen::MatrixXd(matrix).inverse();
    EXPECT_EQ(selected.nonZeros(), matrix.nonZeros());
    for (int col = 0; col < 40; ++col) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(selected, col);
           entry;
           ++entry) {
        EXPECT_NEAR(entry.value(), inverse(entry.row(), col), 1e-12);
      }
    }
  }
}

TEST(SelectedInverse, Nothing) {
  EXPECT_EQ(SelectedInverse(Eigen::SparseMatrix<double>(0, 0)).rows(), 0);
}

TEST(SelectedInverse, RefusesWhatIsNotPositiveDefinite) {
  Eigen::SparseMatrix<double> matrix = Draw(5, 3);
  matrix.coeffRef(2, 2) = -1.0;
  EXPECT_THROW(SelectedInverse(matrix), std::invalid_argument);
}

}  // namespace
}  // namespace tsar
