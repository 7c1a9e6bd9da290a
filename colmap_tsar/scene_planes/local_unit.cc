// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/local_unit.h"

#include <cstddef>

namespace tsar {
namespace {

LocalUnit UnitOf(const std::vector<Eigen::Vector3d>& places) {
  LocalUnit unit;
  if (places.empty()) {
    return unit;
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) {
    sum += place - places.front();
  }
  const double count = static_cast<double>(places.size());
  unit.origin = places.front() + sum / count;
  double distances = 0.0;
  for (const Eigen::Vector3d& place : places) {
    distances += (place - unit.origin).norm();
  }
  unit.size = distances / count;
  return unit;
}

}  // namespace

Eigen::Vector3d LocalUnit::ToLocal(const Eigen::Vector3d& point) const {
  return (point - origin) / size;
}

WorldPlane LocalUnit::ToLocal(const WorldPlane& plane) const {
  return {plane.normal, plane.Height(origin) / size};
}

PlaneMeasurement LocalUnit::ToLocal(const PlaneMeasurement& measurement) const {
  PlaneMeasurement local = measurement;
  local.center = ToLocal(measurement.center);
  local.foot = ToLocal(measurement.foot);
  local.information *= size * size;
  // Inverse depths are `size` times as large here, and so are their errors.
  local.form.row(3) *= size;
  local.form.col(3) *= size;
  local.form /= size * size;
  return local;
}

Eigen::Vector3d LocalUnit::ToWorld(const Eigen::Vector3d& point) const {
  return origin + size * point;
}

WorldPlane LocalUnit::ToWorld(const WorldPlane& plane) const {
  return {plane.normal, size * plane.offset - plane.normal.dot(origin)};
}

LocalUnit LocalUnitOf(const PlaneAdjustment& adjustment,
                      const std::vector<PlaneMeasurement>& measurements) {
  std::vector<Eigen::Vector3d> places;
  for (const PlaneMeasurement& measurement : measurements) {
    if (measurement.information > 0.0) {
      places.push_back(measurement.center);
      places.push_back(measurement.foot);
    }
  }
  for (const PointOnPlane& point : adjustment.points) {
    places.push_back(point.point);
  }
  for (const PlaneCrease& crease : adjustment.creases) {
    places.push_back(crease.center);
  }
  LocalUnit unit = UnitOf(places);
  if (places.size() < 2 || !(unit.size > 0.0)) {
    for (const WorldPlane& plane : adjustment.planes) {
      places.emplace_back(-plane.offset * plane.normal);
    }
    unit = UnitOf(places);
  }
  if (!(unit.size > 0.0)) {
    unit.size = 1.0;
  }
  return unit;
}

}  // namespace tsar
