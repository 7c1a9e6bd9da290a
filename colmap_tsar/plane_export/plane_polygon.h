// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <Eigen/Core>

namespace tsar {

// A closed line; its last point is joined to its first one.
using Ring = std::vector<Eigen::Vector2d>;

// A part of a plane, in the plane's coordinates. The outline runs
// counterclockwise, the holes clockwise.
struct PlanePolygon {
  Ring outline;
  std::vector<Ring> holes;
};

// Positive where it runs counterclockwise.
double SignedArea(const Ring& ring);

// Without the holes.
double Area(const PlanePolygon& polygon);

// Whether every ring has at least three points and no two edges of the polygon
// meet, but for neighbours at the point that they share.
bool IsSimple(const PlanePolygon& polygon);

}  // namespace tsar
