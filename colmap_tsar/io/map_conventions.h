// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/sparse_model.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// Conventions in which maps of other programs differ from COLMAP's: a number
// that stands for "no depth", and the frame of the normals.

// Some rows of a depth map and its normal map, spread over their height in
// pairs that are a few rows apart: enough to tell conventions.
struct MapSample {
  MapSample(int width, int height);
  // Of whole maps; normal may be empty.
  MapSample(const Image<float>& depth, const Image<Vec3f>& normal);

  int height = 0;         // Of the map.
  std::vector<int> rows;  // Of the map, by row of the images below.
  Image<float> depth;     // In the map's own units; 0 = none.
  Image<Vec3f> normal;    // As in the file; (0, 0, 0) = none.
};

// Calls function(column, row, z) for each sparse point that the image sees and
// whose pixel lies in its map of this size.
template <typename Function>
void ForEachSparsePoint(const SparseModel& model,
                        int image,
                        int width,
                        int height,
                        const Function& function) {
  const SparseModel::ModelImage& view = model.images[image];
  const Camera camera = view.camera.Resized(width, height);
  for (const int index : view.point_indices) {
    const Eigen::Vector3d point =
        camera.rotation * model.points[index] + camera.translation;
    const double x = camera.fx * point.x() / point.z() + camera.cx;
    const double y = camera.fy * point.y() / point.z() + camera.cy;
    if (point.z() > 0.0 && x > -0.5 && y > -0.5 && x < width - 0.5 &&
        y < height - 0.5) {
      function(static_cast<int>(std::lround(x)),
               static_cast<int>(std::lround(y)),
               point.z());
    }
  }
}

// The number that stands for "no depth" in the map of an image, such as 65535,
// 1e10 or the far plane of a renderer; 0 if there is none. It is the largest or
// smallest depth, fills at least one percent of the pixels with a depth, and
// exceeds (or undercuts) by half nearly all others and the sparse points in
// those pixels, or all points of the image if too few lie there. Where the
// image sees no points, it differs from all others by a factor of a hundred.
// Depths may be in units of their own. model: null for values that need not be
// proportional to depths, such as inverse ones, which no points are compared
// to.
float FindNoDepth(const MapSample& sample, const SparseModel* model, int image);

// Sets these depths to 0; no_depth: may be 0.
void ClearNoDepth(float no_depth, std::span<float> depths);

// The frames in which programs write normals.
enum class NormalFrame : uint8_t {
  kCamera = 0,  // x right, y down, z forward.
  kOpenGl = 1,  // x right, y up, z backward.
  kWorld = 2,
};
// Turns normals from a frame into the camera's.
Eigen::Matrix3d ToCameraFrame(NormalFrame frame, const Camera& camera);

struct NormalVerdict {
  NormalFrame frame = NormalFrame::kCamera;
  bool face_away = false;
  // The difference from COLMAP's maps, for users; may be empty.
  std::string remark;
};

// Evidence for the frame of the normals of maps. In the right one, all face the
// camera or all face away from it, and they are at right angles to the surface
// that the depths describe.
class NormalEvidence {
 public:
  // camera: that of the image at any size.
  void Add(const MapSample& sample, const Camera& camera);
  // usual: the frame to assume unless another one is clearly better.
  NormalVerdict Judge(NormalFrame usual) const;

 private:
  static constexpr size_t kNumFrames = 3;

  int64_t num_depths_ = 0;
  int64_t num_normals_ = 0;  // Of pixels with a depth.
  std::array<int64_t, kNumFrames> num_facing_{};
  int64_t num_surfaces_ = 0;  // Of normals with depths around.
  std::array<int64_t, kNumFrames> num_upright_{};
};

// How to convert the maps of an image to COLMAP's conventions.
struct MapConventions {
  float no_depth = 0.f;  // See FindNoDepth().
  // To be applied to the normals.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  std::vector<std::string> remarks;  // What differs, for users.

  void Apply(std::span<float> depths) const { ClearNoDepth(no_depth, depths); }
  void Apply(std::span<Vec3f> normals) const;
};
// Judges the maps of one image on their own.
MapConventions FindConventions(const MapSample& sample,
                               const SparseModel& model,
                               int image);
// The remark for users about a number that FindNoDepth() has found.
std::string NoDepthRemark(float no_depth);

// The remarks about images, with the images of each.
struct ImageRemarks {
  std::map<std::string, std::vector<std::string>> images;

  void Add(const std::vector<std::string>& remarks, const std::string& image);
  void Add(const ImageRemarks& others);
  // Such as "a.jpg and 2 more: the normals ...".
  std::vector<std::string> Lines() const;
};

}  // namespace tsar
