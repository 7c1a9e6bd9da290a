// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Drawn rooms and what discovery is expected to find in them.

#include "colmap_tsar/scene/discovery/discover_planes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {

constexpr int kWall = 0;
constexpr int kLeft = 1;
constexpr int kFloor = 2;
constexpr int kPoster = 3;

// A board that extends this far to either side of its middle.
inline DrawnSurface Board(const Eigen::Vector3d& direction,
                          const Eigen::Vector3d& middle,
                          double half_width) {
  return {PlaneThrough(direction, middle),
          middle,
          [middle, half_width](const Eigen::Vector3d& point) {
            return std::abs(point.x() - middle.x()) < half_width &&
                   std::abs(point.y() - middle.y()) < 0.8;
          }};
}

// Three expected errors in front of the back wall.
inline DrawnSurface Poster() {
  const DrawnSurface wall = SyntheticRoom().surfaces[kWall];
  return Board(wall.plane.normal, wall.middle + 0.075 * wall.plane.normal, 1.0);
}

class DiscoverPlanesTest : public testing::Test {
 protected:
  DiscoveredPlanes Discover(const SyntheticRoom& room) {
    return Discover(room, room.Candidates());
  }
  DiscoveredPlanes Discover(const SyntheticRoom& room,
                            const std::vector<WorldPlane>& candidates) {
    return DiscoverPlanes(room.Views(), candidates, options_, *device_);
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(1);
  DiscoverPlanesOptions options_;
};

// The number of the plane found for a surface; -1 if there is none. unit: of
// length in the room.
inline int Find(const DrawnSurface& surface,
                const std::vector<ScenePlane>& found,
                double unit = 1.0) {
  for (size_t i = 0; i < found.size(); ++i) {
    if (AngleBetween(found[i].plane, surface.plane) < 0.15 &&
        std::abs(found[i].plane.Height(surface.middle)) < 0.003 * unit) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

inline void ExpectSurfaces(const SyntheticRoom& room,
                           const DiscoveredPlanes& found,
                           double unit = 1.0) {
  EXPECT_EQ(found.planes.size(), room.surfaces.size());
  for (size_t i = 0; i < room.surfaces.size(); ++i) {
    EXPECT_GE(Find(room.surfaces[i], found.planes, unit), 0) << "surface " << i;
  }
}

// Every superpixel on one surface is assigned to that surface's plane.
inline void ExpectAssigned(const SyntheticRoom& room,
                           const DiscoveredPlanes& found) {
  ASSERT_EQ(found.assignment.size(), room.seen.size());
  for (size_t view = 0; view < room.seen.size(); ++view) {
    ASSERT_EQ(found.assignment[view].size(), room.seen[view].size());
    for (size_t k = 0; k < room.seen[view].size(); ++k) {
      if (room.seen[view][k] >= 0) {
        EXPECT_EQ(found.assignment[view][k],
                  Find(room.surfaces[room.seen[view][k]], found.planes))
            << "view " << view << ", superpixel " << k;
      }
    }
  }
}

// A found plane's support as the header defines it, where each weight is above
// the maximum.
inline double SupportOf(int plane,
                        const DiscoveredPlanes& found,
                        const std::vector<ObservedView>& views) {
  double support = 0.0;
  for (size_t view = 0; view < views.size(); ++view) {
    const ViewEvidence& evidence = *views[view].evidence;
    const Camera& camera = views[view].camera;
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      if (found.assignment[view][k] != plane) {
        continue;
      }
      double scores = 0.0;
      double confidences = 0.0;
      for (int i = evidence.first_observation[k];
           i < evidence.first_observation[k + 1];
           ++i) {
        const auto& [sample, confidence] = evidence.observations[i];
        DepthObservation observation;
        observation.center = camera.Center();
        observation.ray = camera.rotation.transpose() *
                          Eigen::Vector3d(sample.x, sample.y, 1.0);
        observation.depth = sample.z;
        observation.sigma =
            sample.z * evidence.resolution.RelativeDepthError(sample.z);
        const double residual =
            NormalizedResidual(found.planes[plane].plane, observation);
        scores += confidence * std::max(1.0 - residual * residual, 0.0);
        confidences += confidence;
      }
      support += kMaxSuperpixelWeight * scores / confidences;
    }
  }
  return support;
}

inline void ExpectSameBits(const DiscoveredPlanes& a,
                           const DiscoveredPlanes& b) {
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (size_t i = 0; i < a.planes.size(); ++i) {
    EXPECT_EQ(a.planes[i].plane.normal, b.planes[i].plane.normal);
    EXPECT_EQ(a.planes[i].plane.offset, b.planes[i].plane.offset);
    EXPECT_EQ(a.planes[i].support, b.planes[i].support);
  }
  EXPECT_EQ(a.assignment, b.assignment);
}

}  // namespace tsar
