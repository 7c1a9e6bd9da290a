// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/external_maps.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

// Inverse depth at the neighbor minus that at the pixel; nullopt unless both
// may be on one surface.
std::optional<float> Difference(
    const Image<float>& depth, int x, int y, int step_x, int step_y) {
  constexpr float kMaxJump = 0.05f;
  if (!depth.Contains(x + step_x, y + step_y)) {
    return std::nullopt;
  }
  const float here = depth(x, y);
  const float there = depth(x + step_x, y + step_y);
  if (!(there > 0.f) ||
      std::abs(there - here) > kMaxJump * std::min(here, there)) {
    return std::nullopt;
  }
  return 1.f / there - 1.f / here;
}

// The derivative of the inverse depth along an axis, per pixel.
std::optional<float> Slope(
    const Image<float>& depth, int x, int y, int step_x, int step_y) {
  // Relative noise of the inverse depth on a surface.
  constexpr float kNoise = 0.005f;
  const auto before = Difference(depth, x, y, -step_x, -step_y);
  const auto after = Difference(depth, x, y, step_x, step_y);
  if (!before && !after) {
    return std::nullopt;
  }
  if (!before) {
    return *after;
  }
  if (!after) {
    return -*before;
  }
  const float small = std::min(std::abs(*before), std::abs(*after));
  const float large = std::max(std::abs(*before), std::abs(*after));
  if (large > 2.f * small + kNoise / depth(x, y)) {
    return std::abs(*after) < std::abs(*before) ? *after : -*before;
  }
  return 0.5f * (*after - *before);
}

DepthImage ReadMap(const std::filesystem::path& path, ExternalFormat format) {
  const std::vector<uint8_t> bytes = ReadFileBytes(path);
  switch (format) {
    case ExternalFormat::kAcm:
      return {ParseDmb(bytes, path.string())};
    case ExternalFormat::kApd:
      return {ParseApdMap(bytes, path.string())};
    default:
      return ParseDepthImage(bytes, path);
  }
}

// The unit normal of a pixel in the camera frame, towards it, or zero.
Vec3f ConvertNormal(const Vec3f& stored,
                    const Eigen::Matrix3d* rotation,
                    const Vec3f& ray) {
  constexpr double kMaxDeviation = 1e-4;
  Vec3f normal = stored;
  const Eigen::Vector3d exact(stored.x, stored.y, stored.z);
  const double norm = exact.norm();
  if (!(norm > 0.0)) {
    return {};
  }
  if (rotation != nullptr || std::abs(norm - 1.0) > kMaxDeviation) {
    const Eigen::Vector3d unit =
        (rotation != nullptr ? Eigen::Vector3d(*rotation * exact) : exact) /
        norm;
    normal = ToVec3f(unit);
  }
  return Dot(normal, ray) > 0.f ? -normal : normal;
}

}  // namespace

Image<Vec3f> NormalsFromDepth(const Image<float>& depth,
                              const Intrinsics& intrinsics) {
  Image<Vec3f> normals(depth.Width(), depth.Height());
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      if (!(depth(x, y) > 0.f)) {
        continue;
      }
      const auto slope_x = Slope(depth, x, y, 1, 0);
      const auto slope_y = Slope(depth, x, y, 0, 1);
      if (!slope_x || !slope_y) {
        continue;
      }
      // The plane m . point = 1; m . ray is the inverse depth along the ray.
      const Vec3f ray =
          intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
      Vec3f m = {intrinsics.fx * *slope_x, intrinsics.fy * *slope_y, 0.f};
      m.z = 1.f / depth(x, y) - m.x * ray.x - m.y * ray.y;
      const float norm = Norm(m);
      // The norm is infinite if the inverse of a tiny depth overflows.
      if (norm > 0.f && std::isfinite(norm)) {
        normals(x, y) = -(m * (1.f / norm));
      }
    }
  }
  return normals;
}

ExternalMaps ReadExternalMaps(const ExternalFiles& files,
                              ExternalFormat format) {
  ExternalMaps maps;
  if (format == ExternalFormat::kOpenMvs) {
    Dmap dmap = ParseDmap(ReadFileBytes(files.depth), files.depth.string());
    maps.depth = std::move(dmap.depth);
    maps.normal = std::move(dmap.normal);
    maps.camera = dmap.camera;
    return maps;
  }
  const DepthImage depth = ReadMap(files.depth, format);
  maps.depth = ToDepth(depth.map, files.depth.string());
  maps.is_integer = depth.is_integer;
  if (!files.normal.empty()) {
    maps.normal =
        ToNormals(ReadMap(files.normal, format).map, files.normal.string());
    if (!maps.normal.HasSizeOf(maps.depth)) {
      const auto size_of = [](const auto& map) {
        return ToString(RasterSize{map.Width(), map.Height()});
      };
      throw Error::File(ErrorCode::kMismatch,
                        files.normal.string(),
                        "has " + size_of(maps.normal) +
                            " pixels, the depth map " + size_of(maps.depth),
                        "use maps of one run");
    }
  }
  if (!files.camera.empty()) {
    maps.camera =
        ParseCamFile(ReadFileBytes(files.camera), files.camera.string());
  }
  return maps;
}

Image<float> ScaledDepth(const Image<float>& depth, double scale) {
  Image<float> scaled(depth.Width(), depth.Height());
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    const auto value = static_cast<float>(depth.Data()[i] * scale);
    scaled.Data()[i] = std::isfinite(value) ? value : 0.f;
  }
  return scaled;
}

ImportedMaps ConvertMaps(const ExternalMaps& external,
                         const Camera& camera,
                         double scale,
                         NormalFrame frame) {
  ImportedMaps maps;
  maps.depth = ScaledDepth(external.depth, scale);
  const int width = maps.depth.Width();
  const int height = maps.depth.Height();
  const Intrinsics intrinsics = camera.Resized(width, height).GetIntrinsics();
  maps.normal = NormalsFromDepth(maps.depth, intrinsics);
  if (!external.normal.Empty()) {
    const Eigen::Matrix3d turn = ToCameraFrame(frame, camera);
    const Eigen::Matrix3d* rotation =
        frame == NormalFrame::kCamera ? nullptr : &turn;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3f normal = ConvertNormal(
            external.normal(x, y),
            rotation,
            intrinsics.Ray(static_cast<float>(x), static_cast<float>(y)));
        if (maps.depth(x, y) > 0.f && !(normal == Vec3f{})) {
          maps.normal(x, y) = normal;
        }
      }
    }
  }
  return maps;
}

}  // namespace tsar
