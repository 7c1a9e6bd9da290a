// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/nearest_distance.h"

#include "colmap_tsar/device/thread_pool.h"

#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include <flann/flann.hpp>

namespace tsar {
namespace {

// FLANN requires a mutable matrix, although it does not change it.
flann::Matrix<double> AsMatrix(const Eigen::Vector3d* points, size_t count) {
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  return {const_cast<double*>(points->data()), count, 3};
}

}  // namespace

void RequireNearestDistances() {}

std::vector<double> NearestDistances(
    const std::vector<Eigen::Vector3d>& queries,
    const std::vector<Eigen::Vector3d>& targets,
    double max_distance) {
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> distances(queries.size(), infinity);
  if (targets.empty()) {
    return distances;
  }
  flann::KDTreeSingleIndex<flann::L2_Simple<double>> index(
      AsMatrix(targets.data(), targets.size()),
      flann::KDTreeSingleIndexParams());
  index.buildIndex();
  // FLANN excludes points at the radius, a float; so it is enlarged slightly.
  const float squared_radius =
      static_cast<float>(max_distance * max_distance) * 1.0001f;
  flann::SearchParams params;
  params.max_neighbors = 1;

  ThreadPool threads(-1);
  threads.Run(std::ssize(queries), [&](int64_t begin, int64_t end) {
    const auto count = static_cast<size_t>(end - begin);
    std::vector<size_t> indices(count);
    flann::Matrix<size_t> index_matrix(indices.data(), count, 1);
    flann::Matrix<double> distance_matrix(&distances[begin], count, 1);
    index.radiusSearch(AsMatrix(&queries[begin], count),
                       index_matrix,
                       distance_matrix,
                       squared_radius,
                       params);
    for (int64_t i = begin; i < end; ++i) {
      const double distance = std::sqrt(distances[i]);
      distances[i] = distance <= max_distance ? distance : infinity;
    }
  });
  return distances;
}

}  // namespace tsar
