// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fused_cloud_writer.h"

#include "colmap_tsar/base/folder.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "The files are little-endian.");

template <typename T>
void Append(const T& value, std::string* bytes) {
  char copy[sizeof(T)];
  std::memcpy(copy, &value, sizeof(T));
  bytes->append(copy, sizeof(T));
}

void AppendVector(const Eigen::Vector3d& vector, std::string* bytes) {
  for (int i = 0; i < 3; ++i) {
    Append(static_cast<float>(vector[i]), bytes);
  }
}

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
  std::string header;
  Append(static_cast<uint64_t>(num_points), &header);
  return header;
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
  constexpr size_t kPointSize = 6 * sizeof(float) + 3;
  EncodedPoints encoded;
  encoded.points.reserve(points.size() * kPointSize);
  const Eigen::Matrix3d to_world = camera.rotation.transpose();
  const Eigen::Vector3d center = camera.Center();
  std::vector<uint32_t> images;
  for (const FusedPoint& point : points) {
    const Eigen::Vector3d position =
        to_world * ToEigen(point.position) + center;
    // Damaged maps give positions beyond the range of floats.
    if (!position.cast<float>().allFinite() ||
        (box && !box->contains(position))) {
      continue;
    }
    AppendVector(position, &encoded.points);
    AppendVector(to_world * ToEigen(point.normal), &encoded.points);
    Append(point.color, &encoded.points);
    images.assign(1, static_cast<uint32_t>(place_in_file));
    for (uint64_t rest = point.sources; rest != 0; rest &= rest - 1) {
      images.push_back(
          static_cast<uint32_t>(source_places_in_file[std::countr_zero(rest)]));
    }
    std::sort(images.begin(), images.end());
    Append(static_cast<uint32_t>(images.size()), &encoded.visibility);
    for (const uint32_t image : images) {
      Append(image, &encoded.visibility);
    }
    ++encoded.count;
  }
  return encoded;
}

FusedCloudWriter::FusedCloudWriter(const ContainedPath& path)
    : visibility_path_(path.Parent() / (path.Filename().string() + ".vis")),
      points_(path),
      visibility_(visibility_path_) {
  Add({0, PlyHeader(0), VisibilityHeader(0)});
}

void FusedCloudWriter::Add(const EncodedPoints& points) {
  points_.Stream() << points.points;
  visibility_.Stream() << points.visibility;
  num_points_ += points.count;
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
