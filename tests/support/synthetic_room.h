// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Measurements of several views in a room whose planes are known.

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <functional>
#include <utility>
#include <vector>

#include "tests/support/synthetic_observations.h"

namespace tsar {

struct DrawnSurface {
  WorldPlane plane;
  Eigen::Vector3d middle;  // Of what is seen of it; on the plane.
  // Which points of the plane exist; all if empty.
  std::function<bool(const Eigen::Vector3d&)> holds;
};

class SyntheticRoom {
 public:
  static constexpr int kWidth = 120;
  static constexpr int kHeight = 90;
  static constexpr int kSuperpixelSize = 10;
  static constexpr int kPixelsOfSuperpixel = kSuperpixelSize * kSuperpixelSize;
  static constexpr int kObservationsOfSuperpixel = 32;
  static constexpr int kNumSuperpixels =
      kWidth * kHeight / (kSuperpixelSize * kSuperpixelSize);
  // At a depth of 5 one pixel of disparity is 0.025.
  static constexpr float kErrorPerDepth = 0.001f;
  // Standard deviation of the depths, in pixels of disparity.
  static constexpr double kNoise = 0.3;

  // A back wall, a wall on the left and a floor, and the given surfaces in
  // front of them, seen by up to four cameras.
  explicit SyntheticRoom(std::vector<DrawnSurface> others = {},
                         size_t num_cameras = 3)
      : surfaces{Surface({0.1, 0.0, -1.0}, {-0.5, -0.2, 4.95}),
                 Surface({1.0, 0.0, 0.1}, {-2.0, 0.0, 4.0}),
                 Surface({0.0, -1.0, 0.0}, {-0.8, 1.4, 4.0})} {
    surfaces.insert(surfaces.end(), others.begin(), others.end());
    const Eigen::Vector3d target(-0.8, 0.5, 5.0);
    for (const Eigen::Vector3d& center : {Eigen::Vector3d(0.0, 0.0, 0.0),
                                          Eigen::Vector3d(-0.6, 0.2, 0.5),
                                          Eigen::Vector3d(0.9, -0.2, 0.2),
                                          Eigen::Vector3d(0.4, 0.1, 0.4)}) {
      if (cameras.size() == num_cameras) {
        break;
      }
      Camera camera = CameraLookingAt(center, target);
      camera.width = kWidth;
      camera.height = kHeight;
      camera.fx = camera.fy = 90.0;
      camera.cx = 0.5 * kWidth;
      camera.cy = 0.5 * kHeight;
      cameras.push_back(camera);
      Philox random(static_cast<uint32_t>(cameras.size()), 0, 0);
      AddView(camera, &random);
    }
  }

  std::vector<ObservedView> Views() const {
    std::vector<ObservedView> views;
    for (size_t i = 0; i < cameras.size(); ++i) {
      views.push_back({&evidence[i], cameras[i]});
    }
    return views;
  }

  // For each view and each surface the surface's plane, turned by up to 1.5
  // degrees about its middle and moved by up to 0.01.
  std::vector<WorldPlane> Candidates() const {
    Philox random(7, 0, 0);
    std::vector<WorldPlane> candidates;
    for (size_t i = 0; i < cameras.size(); ++i) {
      for (const DrawnSurface& surface : surfaces) {
        candidates.push_back(Displaced(surface.plane,
                                       surface.middle,
                                       3.0 * random.NextFloat() - 1.5,
                                       0.02 * random.NextFloat() - 0.01));
      }
    }
    return candidates;
  }

  // Replaces the depths of a superpixel by random ones between 2 and 8.
  void MakeNoise(int view, int superpixel, Philox* random) {
    ViewEvidence& of_view = evidence[view];
    for (int i = of_view.first_observation[superpixel];
         i < of_view.first_observation[superpixel + 1];
         ++i) {
      of_view.observations[i].sample.z = 2.f + 6.f * random->NextFloat();
    }
  }

  // Moves a superpixel's depths away from the camera, by this many pixels of
  // disparity.
  void MoveAway(int view, int superpixel, float pixels) {
    ViewEvidence& of_view = evidence[view];
    for (int i = of_view.first_observation[superpixel];
         i < of_view.first_observation[superpixel + 1];
         ++i) {
      float& depth = of_view.observations[i].sample.z;
      depth *= 1.f + pixels * of_view.resolution.RelativeDepthError(depth);
    }
  }

  // The nearest surface along a ray, and its depth.
  std::pair<int, double> Hit(const Camera& camera,
                             const Eigen::Vector3d& ray) const {
    std::pair<int, double> nearest(-1, 1e9);
    for (size_t i = 0; i < surfaces.size(); ++i) {
      const DepthObservation hit = ObservePlane(surfaces[i].plane, camera, ray);
      if (hit.depth > 0.0 && hit.depth < nearest.second &&
          (!surfaces[i].holds || surfaces[i].holds(hit.Point()))) {
        nearest = {static_cast<int>(i), hit.depth};
      }
    }
    return nearest;
  }

  // The same room in other units and elsewhere.
  void Transform(double scale, const Eigen::Vector3d& shift) {
    for (size_t i = 0; i < cameras.size(); ++i) {
      const Eigen::Vector3d center = scale * cameras[i].Center() + shift;
      cameras[i].translation = -cameras[i].rotation * center;
      evidence[i].resolution.error_per_depth /= static_cast<float>(scale);
      for (Observation& observation : evidence[i].observations) {
        observation.sample.z *= static_cast<float>(scale);
      }
    }
    for (DrawnSurface& surface : surfaces) {
      surface.middle = scale * surface.middle + shift;
      surface.plane.offset =
          scale * surface.plane.offset - surface.plane.normal.dot(shift);
    }
  }

  std::vector<DrawnSurface> surfaces;
  std::vector<Camera> cameras;
  std::vector<ViewEvidence> evidence;
  // For each view and superpixel the surface on which all its observations lie,
  // -1 where it has several.
  std::vector<std::vector<int>> seen;

 private:
  static DrawnSurface Surface(const Eigen::Vector3d& direction,
                              const Eigen::Vector3d& middle) {
    return {PlaneThrough(direction, middle), middle, {}};
  }

  void AddView(const Camera& camera, Philox* random) {
    ViewEvidence view;
    view.width = kWidth;
    view.height = kHeight;
    view.resolution.error_per_depth = kErrorPerDepth;
    std::vector<int> surface_of;
    const int num_columns = kWidth / kSuperpixelSize;
    view.superpixels = Image<uint16_t>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        view.superpixels(x, y) = static_cast<uint16_t>(
            y / kSuperpixelSize * num_columns + x / kSuperpixelSize);
      }
    }
    for (int k = 0; k < kNumSuperpixels; ++k) {
      view.weights.push_back(kPixelsOfSuperpixel);
      view.first_observation.push_back(
          static_cast<int>(view.observations.size()));
      for (int i = 0; i < kObservationsOfSuperpixel; ++i) {
        const int pixel = i * kPixelsOfSuperpixel / kObservationsOfSuperpixel;
        const int x =
            k % num_columns * kSuperpixelSize + pixel % kSuperpixelSize;
        const int y =
            k / num_columns * kSuperpixelSize + pixel / kSuperpixelSize;
        const Eigen::Vector3d ray(
            (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
        const auto [surface, depth] = Hit(camera, ray);
        const float error =
            view.resolution.RelativeDepthError(static_cast<float>(depth));
        Observation observation;
        observation.sample = {
            static_cast<float>(ray.x()),
            static_cast<float>(ray.y()),
            static_cast<float>(depth *
                               (1.0 + kNoise * error * NextNormal(random)))};
        observation.confidence = 0.5f + 0.5f * random->NextFloat();
        view.observations.push_back(observation);
        view.sources.push_back(ObservationSource::kMeasured);
        if (i == 0) {
          surface_of.push_back(surface);
        } else if (surface_of.back() != surface) {
          surface_of.back() = -1;
        }
      }
    }
    view.first_observation.push_back(
        static_cast<int>(view.observations.size()));
    evidence.push_back(std::move(view));
    seen.push_back(std::move(surface_of));
  }
};

// Removes observation i of superpixel k if is_gone(k, i).
template <typename Function>
void Forget(const Function& is_gone, ViewEvidence* evidence) {
  ViewEvidence kept = *evidence;
  kept.observations.clear();
  kept.sources.clear();
  for (int k = 0; k < evidence->NumSuperpixels(); ++k) {
    const int begin = evidence->first_observation[k];
    const int end = evidence->first_observation[k + 1];
    int count = 0;
    for (int i = begin; i < end; ++i) {
      if (!is_gone(k, i)) {
        kept.observations.push_back(evidence->observations[i]);
        kept.sources.push_back(evidence->sources[i]);
        ++count;
      }
    }
    kept.first_observation[k + 1] = static_cast<int>(kept.observations.size());
    kept.weights[k] *=
        static_cast<float>(count) / static_cast<float>(end - begin);
  }
  *evidence = std::move(kept);
}

}  // namespace tsar
