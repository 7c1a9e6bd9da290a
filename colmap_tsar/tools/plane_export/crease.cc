// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/crease.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace tsar {
namespace {

// The largest distance of a border of labels from the crease, in pixels.
constexpr double kMaxDistance = 6.0;
constexpr int64_t kMinPixels = 8;

Crease Intersect(int first,
                 int second,
                 const std::vector<PlaneCoordinates>& planes) {
  const PlaneCoordinates& a = planes[first];
  const PlaneCoordinates& b = planes[second];
  Crease crease;
  crease.first = first;
  crease.second = second;
  const Eigen::Vector3d direction = a.normal.cross(b.normal);
  if (direction.norm() < kMinSine) {
    crease.direction.setZero();
    return crease;
  }
  crease.direction = direction.normalized();
  Eigen::Matrix3d normals;
  normals << a.normal.transpose(), b.normal.transpose(),
      crease.direction.transpose();
  // The world's origin may be far away: a's is used instead.
  crease.point =
      a.origin +
      normals.inverse() *
          Eigen::Vector3d(0.0, b.normal.dot(b.origin - a.origin), 0.0);
  return crease;
}

}  // namespace

void CreaseFinder::Add(const PlaneView& view) {
  const std::vector<PlaneProjection> projections =
      ProjectionsOf(planes_, view.camera);
  for (int y = 0; y < view.planes.Height(); ++y) {
    for (int x = 0; x < view.planes.Width(); ++x) {
      if (x > 0) {
        AddPair(view, projections, {x, y}, {x - 1, y});
      }
      if (y > 0) {
        AddPair(view, projections, {x, y}, {x, y - 1});
      }
    }
  }
}

void CreaseFinder::AddPair(const PlaneView& view,
                           const std::vector<PlaneProjection>& projections,
                           const Eigen::Vector2i& pixel,
                           const Eigen::Vector2i& neighbor) {
  const int p = view.planes(pixel.x(), pixel.y()) - 1;
  const int q = view.planes(neighbor.x(), neighbor.y()) - 1;
  if (p < 0 || q < 0 || p == q) {
    return;
  }
  const auto [place, is_new] =
      creases_.try_emplace({std::min(p, q), std::max(p, q)});
  Crease& crease = place->second;
  if (is_new) {
    crease = Intersect(place->first.first, place->first.second, planes_);
  }
  if (crease.direction.isZero()) {
    return;
  }
  // If one plane occludes the other, they touch only in the image.
  Eigen::Vector2d along;
  int number = 0;
  for (const auto& [plane, at] :
       {std::pair(p, pixel), std::pair(q, neighbor)}) {
    PlaneProjection::Hit hit;
    if (!projections[plane].Intersect(at.x(), at.y(), &hit)) {
      return;
    }
    const Eigen::Vector3d offset =
        planes_[plane].ToWorld(hit.point) - crease.point;
    if (offset.cross(crease.direction).norm() >
        kMaxDistance * hit.extent.maxCoeff()) {
      return;
    }
    along[number++] = crease.direction.dot(offset);
  }
  if (crease.num_pixels == 0) {
    crease.begin = crease.end = along[0];
  }
  crease.begin = std::min(crease.begin, along.minCoeff());
  crease.end = std::max(crease.end, along.maxCoeff());
  ++crease.num_pixels;
}

std::vector<Crease> CreaseFinder::Creases() const {
  std::vector<Crease> creases;
  for (const auto& [planes, crease] : creases_) {
    if (crease.num_pixels >= kMinPixels) {
      creases.push_back(crease);
    }
  }
  return creases;
}

std::vector<CreaseLine> CreasesOf(int p,
                                  const PlaneCoordinates& coordinates,
                                  const std::vector<Crease>& creases) {
  std::vector<CreaseLine> lines;
  for (const Crease& crease : creases) {
    if (crease.first == p || crease.second == p) {
      lines.push_back({coordinates.ToPlane(crease.point),
                       {coordinates.axis_s.dot(crease.direction),
                        coordinates.axis_t.dot(crease.direction)},
                       crease.begin,
                       crease.end});
    }
  }
  return lines;
}

}  // namespace tsar
