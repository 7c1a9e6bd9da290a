// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace tsar {

// The log-odds of an outcome as a linear function of what is known before.
struct LogisticRegression {
  Eigen::MatrixXd rows;      // Per sample: a constant 1, then what is known.
  Eigen::VectorXd outcomes;  // 0 or 1.
  Eigen::VectorXd weights;   // Their sum is 1.

  // The weights of a row's values, by Newton's method on the regularized
  // likelihood.
  Eigen::VectorXd Solve() const {
    constexpr double kRegularization = 1e-6;
    constexpr int kNumIterations = 25;
    Eigen::VectorXd penalty =
        Eigen::VectorXd::Constant(rows.cols(), kRegularization);
    penalty(0) = 0.0;
    Eigen::VectorXd solution = Eigen::VectorXd::Zero(rows.cols());
    for (int i = 0; i < kNumIterations; ++i) {
      const Eigen::ArrayXd probabilities =
          1.0 / (1.0 + (-(rows * solution).array()).exp());
      const Eigen::VectorXd gradient =
          rows.transpose() *
              (weights.array() * (outcomes.array() - probabilities)).matrix() -
          penalty.cwiseProduct(solution);
      const Eigen::ArrayXd curvature =
          weights.array() * probabilities * (1.0 - probabilities);
      Eigen::MatrixXd hessian =
          rows.transpose() * curvature.matrix().asDiagonal() * rows;
      hessian.diagonal() += penalty;
      hessian.diagonal().array() += 1e-12;
      solution += hessian.ldlt().solve(gradient);
    }
    return solution;
  }
};

}  // namespace tsar
