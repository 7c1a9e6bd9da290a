// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace tsar {

// One observation: the values of the terms, and whether the event occurred.
struct Case {
  Eigen::VectorXd row;  // A constant 1 first.
  bool outcome = false;
  double weight = 0.0;  // 0: the case does not count.
};

// The weights of a row's values that give the log-odds of the outcome: the
// largest regularized likelihood, by Newton's method. cases: at least one, of
// equally long rows; their weights need not have a sum of 1.
inline Eigen::VectorXd SolveLogisticRegression(const std::vector<Case>& cases) {
  constexpr double kRegularization = 1e-6;
  constexpr int kNumIterations = 25;
  const auto num_rows = static_cast<Eigen::Index>(cases.size());
  Eigen::MatrixXd rows(num_rows, cases[0].row.size());
  Eigen::VectorXd outcomes(num_rows);
  Eigen::VectorXd weights(num_rows);
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const Case& one = cases[i];
    rows.row(i) = one.row;
    outcomes(i) = one.outcome ? 1.0 : 0.0;
    weights(i) = one.weight;
  }
  weights /= weights.sum();
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

// At most max_count samples, evenly spaced.
template <typename T>
std::vector<T> TakeEvenly(const std::vector<T>& samples, size_t max_count) {
  std::vector<T> taken;
  const size_t count = std::min(samples.size(), max_count);
  for (size_t i = 0; i < count; ++i) {
    taken.push_back(samples[i * samples.size() / count]);
  }
  return taken;
}

// The weights from the samples of several scenes, all of which count equally.
// make_case: the Case of a sample.
template <typename Sample, typename MakeCase>
Eigen::VectorXd SolveRegression(const std::vector<std::vector<Sample>>& scenes,
                                const MakeCase& make_case) {
  std::vector<Case> cases;
  for (const std::vector<Sample>& scene : scenes) {
    for (const Sample& sample : scene) {
      Case made = make_case(sample);
      if (made.weight > 0.0) {
        made.weight /= static_cast<double>(scene.size());
        cases.push_back(std::move(made));
      }
    }
  }
  return cases.empty() ? Eigen::VectorXd() : SolveLogisticRegression(cases);
}

// Where there are several scenes, calls print(name, scene, weights) for each
// with the weights from the others. Then prints those from all.
template <typename Sample, typename Fit, typename Print>
void CrossValidate(const std::vector<std::vector<Sample>>& scenes,
                   const char* const* names,
                   const Fit& fit,
                   const Print& print,
                   const char* title) {
  for (size_t i = 0; scenes.size() > 1 && i < scenes.size(); ++i) {
    std::vector<std::vector<Sample>> others = scenes;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    print(names[i], scenes[i], fit(others));
  }
  std::printf("%s:", title);
  for (const double weight : fit(scenes)) {
    std::printf(" %.2f", weight);
  }
  std::printf("\n");
}

}  // namespace tsar
