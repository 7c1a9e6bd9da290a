// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// The unit of benchmarks/build_time: parses the standard library and Eigen, and
// generates code of both. It includes nothing of the project and stays as it is,
// so that multiples of it can be compared between commits and machines.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

Eigen::Vector3d LeastDirection(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    scatter += point * point.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  return solver.eigenvectors().col(0);
}

std::vector<std::string> MostFrequent(const std::vector<std::string>& words) {
  std::map<std::string, int> counts;
  for (const std::string& word : words) {
    ++counts[word];
  }
  std::vector<std::string> sorted;
  for (const auto& [word, count] : counts) {
    sorted.push_back(word);
  }
  std::sort(sorted.begin(),
            sorted.end(),
            [&](const std::string& a, const std::string& b) {
              return counts.at(a) > counts.at(b);
            });
  return sorted;
}
