// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/fusion/fuse_view.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace tsar {

// The points of one image in the file formats of COLMAP's stereo_fusion.
struct EncodedPoints {
  int64_t count = 0;
  std::string points;                // For the PLY file.
  std::vector<uint32_t> visibility;  // For the .vis file.
};

// Encodes points in the world frame, in single precision like COLMAP. box: in
// the world frame; points outside of it are left out. place_in_file,
// source_places_in_file: the indices of the image and its sources in the file
// of the sparse model.
EncodedPoints EncodePoints(const std::vector<FusedPoint>& points,
                           const Camera& camera,
                           const std::optional<Eigen::AlignedBox3d>& box,
                           int place_in_file,
                           const std::vector<int>& source_places_in_file);

// The two files that COLMAP's stereo_fusion writes, fused.ply (binary; x, y, z,
// normal, color) and fused.ply.vis (for each point the images that agree on it,
// for COLMAP's delaunay_mesher). Each is written completely or not at all.
class FusedCloudWriter {
 public:
  // path: the PLY file. Throws what AtomicFile throws.
  explicit FusedCloudWriter(const ContainedPath& path);

  // Writes the points of each image in the order of these places, which begin
  // at 0; images that come earlier wait. Can be called from several threads.
  // Throws Error kIo, naming the file, where it cannot be written; then other
  // calls do nothing.
  void Add(size_t place, EncodedPoints points);

  int64_t NumPoints() const { return num_points_; }

  // Replaces both files. A program that is killed meanwhile leaves no .vis file
  // that belongs to another cloud. Throws what AtomicFile and RemoveFile throw.
  void Commit();

 private:
  ContainedPath visibility_path_;
  AtomicFile points_;
  AtomicFile visibility_;
  std::mutex mutex_;
  // Stays where a write fails.
  bool is_writing_ = false;
  size_t next_place_ = 0;
  std::map<size_t, EncodedPoints> waiting_;
  int64_t num_points_ = 0;
};

}  // namespace tsar
