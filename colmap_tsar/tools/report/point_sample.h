// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Points for the 3D view, relative to an origin near them, so that single
// precision suffices for georeferenced models.
struct PointSample {
  std::vector<float> positions;  // x, y, z of each.
  std::vector<Rgb> colors;       // One per point.
  int64_t num_all = 0;           // Points before sampling.

  size_t NumPoints() const { return colors.size(); }
  void Add(const Eigen::Vector3d& point, const Rgb& color);
  void Append(const PointSample& other);
};

// At most max_num_points of a PLY file, evenly spaced in it; gray if it has no
// colors. Throws the errors of ReadPlyCloud.
PointSample SampleCloud(const std::filesystem::path& path,
                        const Eigen::Vector3d& origin,
                        int64_t max_num_points);

// The step of a square grid with at most max_num_points in a map of this size.
int GridStep(int width, int height, int64_t max_num_points);

// The points of a map on such a grid. camera, colors: of the map's size.
PointSample SampleMap(const Image<float>& depth,
                      const Image<Rgb>& colors,
                      const Camera& camera,
                      const Eigen::Vector3d& origin,
                      int step);

// Points as a script, since a page may not read files: tsarPoints("NAME",
// "BASE64") of positions as float32, little-endian, then colors as bytes.
std::string PointScript(const std::string& name, const PointSample& sample);

// A pose of the 3D view, relative to the points' origin.
struct Viewpoint {
  Eigen::Vector3d eye;
  Eigen::Vector3d target;  // The view turns about it.
};

// The pose of the camera that sees most of the scene: the largest part of the
// volume elements that hold points, behind no other points. Neither a camera
// that faces a wall at arm's length nor one with a wall before it is chosen,
// however many points are there. The target is on the camera's axis at the
// median depth. Nothing where no camera sees a point. origin: of the points.
std::optional<Viewpoint> ChooseViewpoint(const std::vector<Camera>& cameras,
                                         const PointSample& points,
                                         const Eigen::Vector3d& origin);

}  // namespace tsar
