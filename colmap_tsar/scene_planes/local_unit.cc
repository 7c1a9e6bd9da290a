// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/local_unit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace tsar {
namespace {

// The upper one of two; leaves the values in another order.
double Median(std::vector<double>* values) {
  const auto middle =
      values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

LocalUnit UnitOf(const std::vector<Eigen::Vector3d>& places) {
  LocalUnit unit;
  if (places.empty()) {
    return unit;
  }
  std::vector<double> values(places.size());
  for (int i = 0; i < 3; ++i) {
    std::transform(places.begin(),
                   places.end(),
                   values.begin(),
                   [&](const Eigen::Vector3d& place) { return place[i]; });
    unit.origin[i] = Median(&values);
  }
  double sum = 0.0;
  for (size_t k = 0; k < places.size(); ++k) {
    values[k] = (places[k] - unit.origin).norm();
    sum += values[k];
  }
  unit.size = Median(&values);
  // Most of them are one.
  if (!(unit.size > 0.0)) {
    unit.size = sum / static_cast<double>(places.size());
  }
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
  if (!std::isfinite(unit.size)) {
    throw std::invalid_argument("AdjustPlanes: lengths are too large");
  }
  return unit;
}

}  // namespace tsar
