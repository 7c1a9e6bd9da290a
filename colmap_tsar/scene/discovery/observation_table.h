// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Selects a superpixel's observations: those of the views themselves, measured
// or on planes of regions, or those of their priors.
enum class ObservationsOf { kViews, kPriors };

// The input of DiscoverPlanes: the superpixels of all views, in the order of
// the views, with their observations in the frame of the first camera. Keeps
// pointers into the views' evidence.
class ObservationTable {
 public:
  // The weight of a superpixel is at most kMaxSuperpixelWeight.
  explicit ObservationTable(const std::vector<ObservedView>& views,
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
  DepthObservation At(int superpixel, int index) const;

  // Calls add(observation) for a sample of about this many of the observations
  // of some superpixels, or for all if there are less, and returns the size of
  // the sample, which hardly changes where a single observation comes or goes.
  template <typename Function>
  size_t Sample(const std::vector<int>& members,
                size_t max_samples,
                const Function& add) const {
    size_t count = 0;
    for (const int k : members) {
      count += NumObservations(k);
    }
    const uint64_t share = count > max_samples
                               ? (uint64_t{max_samples} << 32) / count
                               : uint64_t{1} << 32;
    size_t num_added = 0;
    for (const int k : members) {
      for (int i = 0; i < NumObservations(k); ++i) {
        if (SamplingKey(k, i) < share) {
          add(At(k, i));
          ++num_added;
        }
      }
    }
    return num_added;
  }

 private:
  // A low-discrepancy sequence in both indices, in units of 2^-32. Its steps
  // are the fractions of powers of the plastic number.
  uint32_t SamplingKey(int superpixel, int observation) const {
    const int own = superpixel - frames_[views_[superpixel]].first_superpixel;
    return static_cast<uint32_t>(own) * 3242174889u +
           static_cast<uint32_t>(observation) * 2447445414u;
  }

  struct Frame {
    Eigen::Vector3d center;
    Eigen::Matrix3d rotation;  // From the camera's frame.
    DepthResolution resolution;
    int first_superpixel;
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
