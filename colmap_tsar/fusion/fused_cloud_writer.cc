// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fused_cloud_writer.h"

#include "colmap_tsar/base/folder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "The files are little-endian.");

Eigen::Vector3d ToEigen(const Vec3f& vector) {
  return Eigen::Vector3d(vector.x, vector.y, vector.z);
}

// The length is the same for any number, so that it can be written first.
std::string PlyHeader(int64_t num_points) {
  constexpr size_t kNumDigits = 20;
  const std::string number = std::to_string(num_points);
  return "ply\nformat binary_little_endian 1.0\ncomment tsar_fuse" +
         std::string(kNumDigits - number.size(), ' ') + "\nelement vertex " +
         number +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "end_header\n";
}

std::string VisibilityHeader(int64_t num_points) {
  return {reinterpret_cast<const char*>(&num_points), sizeof(num_points)};
}

void Rewrite(const std::string& header, AtomicFile* file) {
  file->Stream().seekp(0);
  file->Stream() << header;
  file->Prepare();
}

}  // namespace

EncodedPoints EncodePoints(const std::vector<FusedPoint>& points,
                           const Camera& camera,
                           const std::optional<Eigen::AlignedBox3d>& box,
                           int place_in_file,
                           const std::vector<int>& source_places_in_file) {
  size_t num_images = 0;
  for (const FusedPoint& point : points) {
    num_images += 2 + static_cast<size_t>(std::popcount(point.sources));
  }
  std::array<float, 6> coordinates;
  Eigen::Map<Eigen::Vector3f> position(&coordinates[0]);
  Eigen::Map<Eigen::Vector3f> normal(&coordinates[3]);
  EncodedPoints encoded;
  encoded.points.reserve(points.size() * (sizeof(coordinates) + sizeof(Rgb)));
  encoded.visibility.reserve(num_images);
  const Eigen::Matrix3d to_world = camera.rotation.transpose();
  const Eigen::Vector3d center = camera.Center();
  for (const FusedPoint& point : points) {
    const Eigen::Vector3d in_world =
        to_world * ToEigen(point.position) + center;
    position = in_world.cast<float>();
    // Damaged maps give positions beyond the range of floats.
    if (!position.allFinite() || (box && !box->contains(in_world))) {
      continue;
    }
    normal = (to_world * ToEigen(point.normal)).cast<float>();
    encoded.points.append(reinterpret_cast<const char*>(&coordinates),
                          sizeof(coordinates));
    encoded.points.append(reinterpret_cast<const char*>(&point.color),
                          sizeof(Rgb));
    std::vector<uint32_t>& images = encoded.visibility;
    images.push_back(1 + static_cast<uint32_t>(std::popcount(point.sources)));
    const auto num_before = static_cast<std::ptrdiff_t>(images.size());
    images.push_back(static_cast<uint32_t>(place_in_file));
    for (uint64_t rest = point.sources; rest != 0; rest &= rest - 1) {
      images.push_back(
          static_cast<uint32_t>(source_places_in_file[std::countr_zero(rest)]));
    }
    std::sort(images.begin() + num_before, images.end());
    ++encoded.count;
  }
  return encoded;
}

FusedCloudWriter::FusedCloudWriter(const ContainedPath& path)
    : visibility_path_(path.Parent() / (path.Filename().string() + ".vis")),
      points_(path),
      visibility_(visibility_path_) {
  points_.Stream() << PlyHeader(0);
  visibility_.Stream() << VisibilityHeader(0);
}

void FusedCloudWriter::Add(size_t place, EncodedPoints points) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (std::exchange(is_writing_, true)) {
    return;
  }
  waiting_.emplace(place, std::move(points));
  for (auto next = waiting_.begin();
       next != waiting_.end() && next->first == next_place_;
       next = waiting_.erase(next)) {
    const EncodedPoints& encoded = next->second;
    points_.Stream() << encoded.points;
    visibility_.Stream().write(
        reinterpret_cast<const char*>(encoded.visibility.data()),
        static_cast<std::streamsize>(encoded.visibility.size() *
                                     sizeof(uint32_t)));
    num_points_ += encoded.count;
    ++next_place_;
  }
  is_writing_ = false;
}

void FusedCloudWriter::Commit() {
  Rewrite(PlyHeader(num_points_), &points_);
  Rewrite(VisibilityHeader(num_points_), &visibility_);
  // From here on, the old visibility would belong to another cloud.
  RemoveFile(visibility_path_);
  points_.Commit();
  visibility_.Commit();
}

}  // namespace tsar
