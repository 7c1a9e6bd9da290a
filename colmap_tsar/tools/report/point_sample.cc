// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/point_sample.h"

#include "colmap_tsar/io/ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "Positions are copied as they lie in memory.");
static_assert(sizeof(Rgb) == 3, "Colors are copied as they lie in memory.");

constexpr Rgb kWithoutColor = {170, 170, 170};

std::string EncodeBase64(const std::string& bytes) {
  static const char letters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) {
      bits = bits << 8 |
             (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += k <= count ? letters[bits >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

}  // namespace

void PointSample::Add(const Eigen::Vector3d& point, const Rgb& color) {
  for (int axis = 0; axis < 3; ++axis) {
    positions.push_back(static_cast<float>(point[axis]));
  }
  colors.push_back(color);
}

void PointSample::Append(const PointSample& other) {
  positions.insert(
      positions.end(), other.positions.begin(), other.positions.end());
  colors.insert(colors.end(), other.colors.begin(), other.colors.end());
  num_all += other.num_all;
}

PointSample SampleCloud(const std::filesystem::path& path,
                        const Eigen::Vector3d& origin,
                        int64_t max_num_points) {
  const PlyCloud cloud =
      ReadPlyCloud(path, static_cast<uint64_t>(max_num_points));
  PointSample sample;
  sample.num_all = static_cast<int64_t>(cloud.num_points_read);
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    sample.Add(cloud.points[i] - origin,
               cloud.colors.empty() ? kWithoutColor : cloud.colors[i]);
  }
  return sample;
}

int GridStep(int width, int height, int64_t max_num_points) {
  int step = 1;
  const auto count = [&step](int size) {
    return static_cast<int64_t>((size + step - 1) / step);
  };
  while (count(width) * count(height) > std::max<int64_t>(1, max_num_points)) {
    ++step;
  }
  return step;
}

PointSample SampleMap(const Image<float>& depth,
                      const Image<Rgb>& colors,
                      const Camera& camera,
                      const Eigen::Vector3d& origin,
                      int step) {
  PointSample sample;
  sample.num_all =
      std::ranges::count_if(depth, [](float z) { return z > 0.f; });
  // The center of the first cell, unless the map is too small.
  const auto first = [step](int size) { return std::min(step / 2, size - 1); };
  for (int y = first(depth.Height()); y < depth.Height(); y += step) {
    for (int x = first(depth.Width()); x < depth.Width(); x += step) {
      const double z = depth(x, y);
      if (z > 0.0) {
        const Eigen::Vector3d in_camera(z * (x - camera.cx) / camera.fx,
                                        z * (y - camera.cy) / camera.fy,
                                        z);
        sample.Add(camera.rotation.transpose() * in_camera +
                       (camera.Center() - origin),
                   colors(x, y));
      }
    }
  }
  return sample;
}

std::string PointScript(const std::string& name, const PointSample& sample) {
  const size_t num_position_bytes = sample.positions.size() * sizeof(float);
  std::string bytes(num_position_bytes + 3 * sample.colors.size(), '\0');
  if (!sample.colors.empty()) {
    std::memcpy(bytes.data(), sample.positions.data(), num_position_bytes);
    std::memcpy(bytes.data() + num_position_bytes,
                sample.colors.data(),
                3 * sample.colors.size());
  }
  return "tsarPoints(\"" + name + "\", \"" + EncodeBase64(bytes) + "\");\n";
}

}  // namespace tsar
