// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/point_sample.h"

#include "colmap_tsar/io/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Geometry>

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

// Points and cameras that are looked at; more do not change what is chosen.
constexpr size_t kMaxPoints = 50000;
constexpr size_t kMaxCameras = 100;
// Of the coordinates along each axis, this share at either end may be outliers.
constexpr double kOutliers = 0.03;
// Volume elements along the diagonal of the scene.
constexpr double kElements = 64.0;
// Each side of an image is divided into as many cells. Points farther than the
// nearest in their cell, by this factor and two elements, are hidden.
constexpr int kCells = 32;
constexpr double kHidden = 1.1;

// The scene as volume elements.
struct Elements {
  double size = 0.0;
  std::vector<Eigen::Vector3d> points;  // One in each, in the world frame.
};

// The box that holds most points.
Eigen::AlignedBox3d RobustBox(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(
        points, values.begin(), [axis](const Eigen::Vector3d& p) {
          return p[axis];
        });
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    box.min()[axis] = values[kOutliers * last];
    box.max()[axis] = values[(1.0 - kOutliers) * last];
  }
  return box;
}

// The volume elements of the scene that hold points.
Elements FindElements(const PointSample& sample,
                      const Eigen::Vector3d& origin) {
  Elements elements;
  std::vector<Eigen::Vector3d>& points = elements.points;
  const size_t step = 1 + sample.NumPoints() / kMaxPoints;
  for (size_t i = 0; i < sample.NumPoints(); i += step) {
    const float* position = &sample.positions[3 * i];
    points.push_back(origin +
                     Eigen::Vector3d(position[0], position[1], position[2]));
  }
  if (points.empty()) {
    return elements;
  }
  const Eigen::AlignedBox3d box = RobustBox(points);
  const double size = box.diagonal().norm() / kElements;
  elements.size = size;
  std::set<std::array<int, 3>> seen;
  std::erase_if(points, [&](const Eigen::Vector3d& point) {
    if (!box.contains(point)) {
      return true;
    }
    std::array<int, 3> element = {};
    for (int axis = 0; axis < 3 && size > 0.0; ++axis) {
      element[axis] = static_cast<int>((point[axis] - box.min()[axis]) / size);
    }
    return !seen.insert(element).second;
  });
  return elements;
}

// The cells within reach of a coordinate in cells: all that an element covers.
std::pair<int, int> Covered(double at, double reach) {
  return {static_cast<int>(std::max(0.0, at - reach)),
          static_cast<int>(std::min(kCells - 1.0, at + reach))};
}

// The depths of the elements that a camera sees, in any order.
std::vector<double> VisibleDepths(const Camera& camera,
                                  const Elements& elements) {
  struct Seen {
    int x, y;
    double depth;
  };
  std::vector<Seen> all;
  Image<double> nearest(
      kCells, kCells, std::numeric_limits<double>::infinity());
  const double x_scale = 1.0 * kCells / camera.width;
  const double y_scale = 1.0 * kCells / camera.height;
  for (const Eigen::Vector3d& point : elements.points) {
    const Eigen::Vector3d p = camera.rotation * (point - camera.Center());
    if (p.z() <= 0.0) {
      continue;
    }
    const double x = (camera.fx * p.x() / p.z() + camera.cx + 0.5) * x_scale;
    const double y = (camera.fy * p.y() / p.z() + camera.cy + 0.5) * y_scale;
    if (!(x >= 0.0 && x < kCells && y >= 0.0 && y < kCells)) {
      continue;
    }
    all.push_back({static_cast<int>(x), static_cast<int>(y), p.z()});
    const double reach = elements.size / p.z();
    const auto [left, right] = Covered(x, reach * camera.fx * x_scale);
    const auto [top, bottom] = Covered(y, reach * camera.fy * y_scale);
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        nearest(column, row) = std::min(nearest(column, row), p.z());
      }
    }
  }
  std::vector<double> depths;
  for (const Seen& seen : all) {
    if (seen.depth <= kHidden * nearest(seen.x, seen.y) + 2.0 * elements.size) {
      depths.push_back(seen.depth);
    }
  }
  return depths;
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

std::optional<Viewpoint> ChooseViewpoint(const std::vector<Camera>& cameras,
                                         const PointSample& sample,
                                         const Eigen::Vector3d& origin) {
  const Elements elements = FindElements(sample, origin);
  std::optional<Viewpoint> best;
  size_t most = 0;
  const size_t step = 1 + cameras.size() / kMaxCameras;
  for (size_t i = 0; i < cameras.size(); i += step) {
    std::vector<double> depths = VisibleDepths(cameras[i], elements);
    if (depths.size() > most) {
      most = depths.size();
      const auto middle =
          depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
      std::ranges::nth_element(depths, middle);
      const Eigen::Vector3d eye = cameras[i].Center() - origin;
      best = {eye, eye + *middle * cameras[i].rotation.row(2).transpose()};
    }
  }
  return best;
}

}  // namespace tsar
