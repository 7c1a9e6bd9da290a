// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/view/planes/depth_observation.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Selects a superpixel's observations: those of the views themselves, measured
// or on planes of regions, or those of their priors.
enum class ObservationsOf { kViews, kPriors };

// The input of DiscoverPlanes: the superpixels of all views, in the order of
// the views, with their observations in the frame of the first camera. Keeps
// pointers into the views' evidence.
class SuperpixelObservations {
 public:
  // The weight of a superpixel is at most max_weight.
  SuperpixelObservations(const std::vector<ObservedView>& views,
                         double max_weight,
                         ObservationsOf which = ObservationsOf::kViews);

  int Count() const { return static_cast<int>(views_.size()); }
  // The index of each superpixel's view.
  const std::vector<int>& Views() const { return views_; }
  int NumViews() const { return static_cast<int>(frames_.size()); }
  const Eigen::Vector3d& CameraCenter(int view) const {
    return frames_[view].center;
  }

  int NumObservations(int superpixel) const {
    return entries_[superpixel].count;
  }
  // The weights of a superpixel's observations add up to its weight.
  DepthObservation At(int superpixel, int number) const;

  // Calls add(observation) for an evenly spaced sample of the observations of
  // some superpixels, and returns the size of the sample.
  template <typename Function>
  size_t Sample(const std::vector<int>& members,
                size_t max_samples,
                const Function& add) const {
    size_t count = 0;
    for (const int k : members) {
      count += NumObservations(k);
    }
    const size_t num_samples = std::min(count, max_samples);
    size_t num_added = 0;
    size_t num_before = 0;
    for (const int k : members) {
      const size_t own_count = NumObservations(k);
      while (num_added < num_samples) {
        const size_t next = num_added * count / num_samples;
        if (next >= num_before + own_count) {
          break;
        }
        add(At(k, static_cast<int>(next - num_before)));
        ++num_added;
      }
      num_before += own_count;
    }
    return num_samples;
  }

 private:
  struct Frame {
    Eigen::Vector3d center;
    Eigen::Matrix3d rotation;  // From the camera's frame.
    DepthResolution resolution;
  };
  struct Entry {
    const Observation* observations;
    const float* errors;  // Null: all 1.
    int count;
    double weight;
    double confidences;  // Sum over the observations.
  };

  double slack_ = 0.0;
  std::vector<Frame> frames_;
  std::vector<int> views_;
  std::vector<Entry> entries_;
};

}  // namespace tsar
