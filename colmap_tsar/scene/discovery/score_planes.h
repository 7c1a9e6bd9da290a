// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/observation_table.h"
#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <utility>
#include <vector>

namespace tsar {

// Some observations of one superpixel, side by side so that vector units work
// on all at once. Unused entries are zero and add nothing.
struct ObservationBlock {
  static constexpr int kSize = 8;
  float ray_x[kSize] = {};  // Rays have unit length.
  float ray_y[kSize] = {};
  float ray_z[kSize] = {};
  float inverse_distance[kSize] = {};  // Along the ray.
  float precision[kSize] = {};         // Inverse relative tolerance.
  float weight[kSize] = {};
  float slack[kSize] = {};  // See DepthObservation.
};

// The bounding ball of a superpixel's observations and their tolerance: planes
// that do not meet it score 0.
struct Ball {
  Vec3f center;
  float radius = 0.f;
};

// A plane with its score for each superpixel.
struct ScoredPlane {
  ScoredPlane() = default;
  ScoredPlane(const WorldPlane& plane, std::vector<float> scores);

  WorldPlane plane;
  std::vector<float> scores;
  // The few superpixels whose score is not 0.
  std::vector<int> superpixels;
};

// The scale of Cauchy's loss in fits of planes, as a share of the tolerance.
inline constexpr double kCauchyShare = 0.5;

// Scores planes for all superpixels on a device, by the score of
// DiscoverPlanes, and fits them to observations of superpixels. Planes are in
// the frame of the first camera. Keeps references to the arguments.
class PlaneScorer {
 public:
  // tolerance: see DiscoverPlanesOptions.
  PlaneScorer(const ObservationTable& observations,
              double tolerance,
              Device& device);

  const ObservationTable& Observations() const { return observations_; }
  double Tolerance() const { return tolerance_; }
  Device& GetDevice() const { return device_; }
  // See FitPlane.
  double LossScale() const { return kCauchyShare * tolerance_; }

  // As many of the observations of some superpixels as a fit needs.
  FitSamples Sample(const std::vector<int>& members) const;

  WorldPlane Fit(const WorldPlane& initial, const FitSamples& samples) const {
    return FitPlane(initial, samples, LossScale());
  }

  std::vector<ScoredPlane> Score(const std::vector<WorldPlane>& planes) const;
  ScoredPlane ScoreOne(const WorldPlane& plane) const {
    return std::move(Score({plane})[0]);
  }
  // The scores alone, one row per plane.
  Buffer<float> ScoreOnDevice(const std::vector<WorldPlane>& planes) const;

 private:
  const ObservationTable& observations_;
  double tolerance_;
  Device& device_;
  Buffer<int> views_;
  Buffer<Ball> balls_;
  Buffer<ObservationBlock> blocks_;
  Buffer<int> first_block_;
};

// Greedy choice among candidate planes: finds the one that raises the best
// scores of the superpixels most. Lazy evaluation: a candidate's gain never
// grows, so that an old gain is an upper bound, and most are never recomputed.
class LazyGreedySelection {
 public:
  struct Choice {
    int candidate = -1;  // -1 where none gains anything.
    float gain = 0.f;
  };

  LazyGreedySelection(const std::vector<WorldPlane>& candidates,
                      const PlaneScorer& scorer);

  // The score of a candidate for each superpixel.
  std::vector<float> Scores(int candidate) const;

  // best: the score of each superpixel's best plane so far; none may be below
  // that of the call before. Ties go to the first candidate.
  Choice Next(const std::vector<float>& best);

 private:
  void UpdateGains(const std::vector<int>& candidates);

  int num_superpixels_;
  Device& device_;
  Buffer<float> scores_;  // A row for each candidate.
  Buffer<float> best_;
  std::vector<float> gains_;  // The values last computed.
  std::vector<int> order_;
};

}  // namespace tsar
