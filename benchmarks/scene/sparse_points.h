// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/scene/room.h"

namespace tsar {

// A point on a surface with texture, and the images that see it.
struct SparsePoint {
  struct Observation {
    int image = 0;
    double x = 0.0;
    double y = 0.0;
  };
  Eigen::Vector3d position;
  std::vector<Observation> track;
};

// Points under random pixels of all cameras that at least min_track_length
// cameras see; fewer than num_points where such pixels are rare.
std::vector<SparsePoint> SampleSparsePoints(const Room& room,
                                            const std::vector<Camera>& cameras,
                                            int num_points,
                                            int min_track_length,
                                            uint32_t seed);

// COLMAP's text form: cameras.txt, images.txt and points3D.txt.
void WriteSparseModel(const std::filesystem::path& folder,
                      const std::vector<std::string>& names,
                      const std::vector<Camera>& cameras,
                      const std::vector<SparsePoint>& points);

}  // namespace tsar
