// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/score_planes.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_teams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

namespace tsar {

namespace {

// Lower bound of the sine of the angle between ray and plane; see RaySlope.
constexpr float kMinSlope = 0.05f;

// Margin for the rounding of planes that just reach a superpixel: scores are 0
// beyond in any case.
constexpr double kReachMargin = 1.05;

// Superpixels that one call of the kernel scores for one plane: their
// observations stay in the fastest memory while all planes pass.
constexpr int kTileSize = 16;

// scores[plane * num_superpixels + superpixel] for one plane and one tile.
struct ScoreKernel {
  const Ball* balls;
  const ObservationBlock* blocks;
  const int* first_block;  // num_superpixels + 1 entries.
  const int* views;        // Of each superpixel.
  int num_superpixels;
  int num_views;
  const Vec3f* normals;
  const float* offsets;
  const float* heights;  // Camera heights, num_views per plane.
  int num_planes;
  float* scores;

  TSAR_HD void operator()(int64_t item) const {
    const int64_t plane = item % num_planes;
    const int begin = static_cast<int>(item / num_planes) * kTileSize;
    const int end = begin + kTileSize < num_superpixels ? begin + kTileSize
                                                        : num_superpixels;
    const Vec3f normal = normals[plane];
    for (int superpixel = begin; superpixel < end; ++superpixel) {
      const Ball& ball = balls[superpixel];
      float score = 0.f;
      if (!(fabsf(Dot(normal, ball.center) + offsets[plane]) > ball.radius)) {
        score = Score(normal,
                      heights[plane * num_views + views[superpixel]],
                      first_block[superpixel],
                      first_block[superpixel + 1]);
      }
      scores[plane * num_superpixels + superpixel] = score;
    }
  }

  TSAR_HD float Score(const Vec3f& normal,
                      float height,
                      int begin,
                      int end) const {
    float sums[ObservationBlock::kSize] = {};
    for (int b = begin; b < end; ++b) {
      const ObservationBlock& block = blocks[b];
      // Loops without branches are vectorized by compilers.
      float shares[ObservationBlock::kSize];
      for (int i = 0; i < ObservationBlock::kSize; ++i) {
        const float slope = normal.x * block.ray_x[i] +
                            normal.y * block.ray_y[i] +
                            normal.z * block.ray_z[i];
        const float steepness = fabsf(slope);
        const float deviation =
            fabsf(slope + height * block.inverse_distance[i]) *
                block.precision[i] /
                (steepness > kMinSlope ? steepness : kMinSlope) -
            block.slack[i];
        // NaN where the plane is invalid, so that the share is 0.
        const float ratio = deviation < 0.f ? 0.f : deviation;
        const float share = 1.f - ratio * ratio;
        shares[i] = share > 0.f ? share : 0.f;
      }
      for (int i = 0; i < ObservationBlock::kSize; ++i) {
        sums[i] += block.weight[i] * shares[i];
      }
    }
    for (int half = ObservationBlock::kSize / 2; half > 0; half /= 2) {
      for (int i = 0; i < half; ++i) {
        sums[i] += sums[i + half];
      }
    }
    return sums[0];
  }
};

// The number of observations of a fit, where there are more.
constexpr size_t kMaxFittedObservations = 8000;

// One row of scores.
std::vector<float> RowToHost(Device& device,
                             const Buffer<float>& scores,
                             size_t row,
                             size_t num_superpixels) {
  std::vector<float> result(num_superpixels);
  device.CopyToHost(result.data(),
                    scores.Data() + row * num_superpixels,
                    num_superpixels * sizeof(float));
  return result;
}

// A ball around the box and all points within reach of it; of radius 0 where
// the box is empty.
Ball BallAround(const Eigen::AlignedBox3d& box, double reach) {
  if (box.isEmpty()) {
    return {};
  }
  return {ToVec3f(box.center()),
          static_cast<float>(0.5 * box.diagonal().norm() + reach)};
}

// Candidates whose gains are computed at a time.
constexpr int kGainBatch = 64;

// The gain of a candidate: by how much it would raise the best scores.
struct GainKernel {
  const float* scores;
  int num_superpixels;
  const float* best;
  const int* candidates;
  float* gains;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const float* own =
        scores + static_cast<int64_t>(candidates[item]) * num_superpixels;
    const float gain = team.template Accumulate<float>(
        num_superpixels, [&](int i, float* sum) {
          const float difference = own[i] - best[i];
          *sum += difference > 0.f ? difference : 0.f;
        });
    if (team.IsLeader()) {
      gains[item] = gain;
    }
  }
};

}  // namespace

PlaneScorer::PlaneScorer(const ObservationTable& observations,
                         double tolerance,
                         Device& device)
    : observations_(observations),
      tolerance_(tolerance),
      device_(device),
      views_(device, observations.Views()) {
  constexpr int kSize = ObservationBlock::kSize;
  std::vector<int> first_block = {0};
  for (int k = 0; k < observations.Count(); ++k) {
    first_block.push_back(first_block.back() +
                          (observations.NumObservations(k) + kSize - 1) /
                              kSize);
  }
  std::vector<ObservationBlock> blocks(first_block.back());
  std::vector<Ball> balls(observations.Count());
  device.Threads().ForEach(balls.size(), [&](size_t k) {
    Eigen::AlignedBox3d box;
    double reach = 0.0;
    for (int i = 0; i < observations.NumObservations(k); ++i) {
      const DepthObservation observation = observations.At(k, i);
      const double length = observation.ray.norm();
      const Eigen::Vector3f ray = (observation.ray / length).cast<float>();
      ObservationBlock& block = blocks[first_block[k] + i / kSize];
      const int lane = i % kSize;
      block.ray_x[lane] = ray.x();
      block.ray_y[lane] = ray.y();
      block.ray_z[lane] = ray.z();
      block.inverse_distance[lane] =
          static_cast<float>(1.0 / (observation.depth * length));
      block.precision[lane] = static_cast<float>(
          observation.depth / (observation.sigma * tolerance));
      block.weight[lane] = static_cast<float>(observation.weight);
      block.slack[lane] = static_cast<float>(observation.slack);
      box.extend(observation.Point());
      reach = std::max(
          reach,
          (1.0 + observation.slack) * observation.sigma * tolerance * length);
    }
    balls[k] = BallAround(box, kReachMargin * reach);
  });
  blocks_ = Buffer<ObservationBlock>(device, blocks);
  first_block_ = Buffer<int>(device, first_block);
  balls_ = Buffer<Ball>(device, balls);
}

FitSamples PlaneScorer::Sample(const std::vector<int>& members) const {
  FitSamples samples;
  observations_.Sample(
      members, kMaxFittedObservations, [&](const DepthObservation& sample) {
        samples.Add(sample);
      });
  return samples;
}

Buffer<float> PlaneScorer::ScoreOnDevice(
    const std::vector<WorldPlane>& planes) const {
  const int num_superpixels = observations_.Count();
  const int num_views = observations_.NumViews();
  std::vector<Vec3f> normals;
  std::vector<float> offsets;
  std::vector<float> heights;
  for (const WorldPlane& plane : planes) {
    normals.push_back(ToVec3f(plane.normal));
    offsets.push_back(static_cast<float>(plane.offset));
    for (int i = 0; i < num_views; ++i) {
      heights.push_back(
          static_cast<float>(plane.Height(observations_.CameraCenter(i))));
    }
  }
  const Buffer<Vec3f> device_normals(device_, normals);
  const Buffer<float> device_offsets(device_, offsets);
  const Buffer<float> device_heights(device_, heights);
  Buffer<float> scores(device_, planes.size() * num_superpixels);
  const int64_t num_tiles = (num_superpixels + kTileSize - 1) / kTileSize;
  ParallelFor(device_,
              num_tiles * static_cast<int64_t>(planes.size()),
              ScoreKernel{balls_.Data(),
                          blocks_.Data(),
                          first_block_.Data(),
                          views_.Data(),
                          num_superpixels,
                          num_views,
                          device_normals.Data(),
                          device_offsets.Data(),
                          device_heights.Data(),
                          static_cast<int>(planes.size()),
                          scores.Data()});
  return scores;
}

ScoredPlane::ScoredPlane(const WorldPlane& plane, std::vector<float> scores)
    : plane(plane), scores(std::move(scores)) {
  for (size_t k = 0; k < this->scores.size(); ++k) {
    if (this->scores[k] > 0.f) {
      superpixels.push_back(static_cast<int>(k));
    }
  }
}

std::vector<ScoredPlane> PlaneScorer::Score(
    const std::vector<WorldPlane>& planes) const {
  const Buffer<float> scores = ScoreOnDevice(planes);
  std::vector<ScoredPlane> scored(planes.size());
  device_.Threads().ForEach(planes.size(), [&](size_t p) {
    scored[p] = ScoredPlane(
        planes[p], RowToHost(device_, scores, p, observations_.Count()));
  });
  return scored;
}

LazyGreedySelection::LazyGreedySelection(
    const std::vector<WorldPlane>& candidates, const PlaneScorer& scorer)
    : num_superpixels_(scorer.Observations().Count()),
      device_(scorer.GetDevice()),
      scores_(scorer.ScoreOnDevice(candidates)),
      best_(device_, num_superpixels_),
      gains_(candidates.size(), std::numeric_limits<float>::infinity()),
      order_(candidates.size()) {
  std::iota(order_.begin(), order_.end(), 0);
}

std::vector<float> LazyGreedySelection::Scores(int candidate) const {
  return RowToHost(device_, scores_, candidate, num_superpixels_);
}

LazyGreedySelection::Choice LazyGreedySelection::Next(
    const std::vector<float>& best) {
  // Gains never grow, computed ones included, since rounding is monotonic: once
  // a gain exceeds the old ones of all remaining candidates, these need not be
  // recomputed.
  best_.Upload(best.data());
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return gains_[a] != gains_[b] ? gains_[a] > gains_[b] : a < b;
  });
  Choice choice;
  for (size_t begin = 0;
       begin < order_.size() && gains_[order_[begin]] >= choice.gain;
       begin += kGainBatch) {
    const size_t end = std::min(begin + kGainBatch, order_.size());
    UpdateGains({order_.begin() + begin, order_.begin() + end});
    for (size_t i = begin; i < end; ++i) {
      const int candidate = order_[i];
      if (gains_[candidate] > choice.gain ||
          (gains_[candidate] == choice.gain && candidate < choice.candidate)) {
        choice = {candidate, gains_[candidate]};
      }
    }
  }
  return choice;
}

void LazyGreedySelection::UpdateGains(const std::vector<int>& candidates) {
  const Buffer<int> device_candidates(device_, candidates);
  Buffer<float> device_gains(device_, candidates.size());
  ParallelForTeams<128>(device_,
                        candidates.size(),
                        GainKernel{scores_.Data(),
                                   num_superpixels_,
                                   best_.Data(),
                                   device_candidates.Data(),
                                   device_gains.Data()});
  const std::vector<float> gains = device_gains.ToHost();
  for (size_t i = 0; i < candidates.size(); ++i) {
    gains_[candidates[i]] = gains[i];
  }
}

}  // namespace tsar
