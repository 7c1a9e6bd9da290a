// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/discover_planes.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for_teams.h"
#include "colmap_tsar/planes/depth_observation.h"
#include "colmap_tsar/planes/fit_plane.h"
#include "colmap_tsar/scene_planes/regular_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// Fits work on evenly spaced observations where there are more.
constexpr size_t kMaxFittedObservations = 2000;
// The scale of Cauchy's loss as a share of the tolerance.
constexpr double kCauchyShare = 0.5;
// Planes are made regular by fewer observations of each: all of them count
// together.
constexpr size_t kMaxAlignedObservations = 500;
// The share of its support that a plane may lose for being regular. Not small:
// what a plane misses by a little it misses in all views, by errors that they
// have in common.
constexpr double kMaxAlignmentLoss = 0.1;
// Of a candidate that was chosen.
constexpr int kNumFirstFits = 2;
constexpr int kMaxImprovingRounds = 3;
// Planes at a larger angle are never merged.
constexpr double kMinMergeCosine = 0.866;  // 30 degrees
// Nor are two planes each of which is worth more than this many times the cost
// of a plane where the other one stays: a joint plane hardly makes up for that.
constexpr double kHopelessGains = 3.0;
// Nor planes that are further apart, in tolerances, where each of them was
// measured; this is told by some of the observations.
constexpr double kMaxMergeDistance = 10.0;
constexpr size_t kNumMergeSamples = 100;
// The flattest angle to a plane that counts, by its sine; see RaySlope.
constexpr float kMinSlope = 0.05f;

// Makes up for the rounding of planes that just reach a customer: scores are 0
// beyond without it, too.
constexpr double kReachMargin = 1.05;

// Customers that one call of the kernel scores for one plane: their
// observations stay in the fastest memory while all planes pass.
constexpr int kTileSize = 16;
// Candidates whose gains are computed at a time.
constexpr int kGainBatch = 64;

// Some observations of one superpixel, side by side so that vector units work
// on all at once. Unused ones are zero and add nothing.
struct ObservationBlock {
  static constexpr int kSize = 8;
  float ray_x[kSize] = {};  // A unit vector.
  float ray_y[kSize] = {};
  float ray_z[kSize] = {};
  float inverse_distance[kSize] = {};  // One over the length along it.
  float precision[kSize] = {};  // One over the tolerance, which is relative.
  float weight[kSize] = {};
};

// Planes that pass by it come near none of a customer's observations.
struct Ball {
  Vec3f center;
  float radius = 0.f;
};

// scores[plane * num_customers + customer] for one plane and one tile.
struct ScoreKernel {
  const Ball* balls;
  const ObservationBlock* blocks;
  const int* first_block;  // num_customers + 1 of them.
  const int* views;        // Of each customer.
  int num_customers;
  int num_views;
  const Vec3f* normals;
  const float* offsets;
  const float* heights;  // num_views of them per plane: of the cameras over it.
  int num_planes;
  float* scores;

  TSAR_HD void operator()(int64_t item) const {
    const int64_t plane = item % num_planes;
    const int begin = static_cast<int>(item / num_planes) * kTileSize;
    const int end =
        begin + kTileSize < num_customers ? begin + kTileSize : num_customers;
    const Vec3f normal = normals[plane];
    for (int customer = begin; customer < end; ++customer) {
      const Ball& ball = balls[customer];
      float score = 0.f;
      if (!(fabsf(Dot(normal, ball.center) + offsets[plane]) > ball.radius)) {
        score = Score(normal,
                      heights[plane * num_views + views[customer]],
                      first_block[customer],
                      first_block[customer + 1]);
      }
      scores[plane * num_customers + customer] = score;
    }
  }

  TSAR_HD float Score(const Vec3f& normal,
                      float height,
                      int begin,
                      int end) const {
    float sums[ObservationBlock::kSize] = {};
    for (int b = begin; b < end; ++b) {
      const ObservationBlock& block = blocks[b];
      // In loops without branches, or compilers use no vector units.
      float shares[ObservationBlock::kSize];
      for (int i = 0; i < ObservationBlock::kSize; ++i) {
        const float slope = normal.x * block.ray_x[i] +
                            normal.y * block.ray_y[i] +
                            normal.z * block.ray_z[i];
        const float steepness = fabsf(slope);
        const float ratio = (slope + height * block.inverse_distance[i]) *
                            block.precision[i] /
                            (steepness > kMinSlope ? steepness : kMinSlope);
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

// By how much a candidate would raise the best scores.
struct GainKernel {
  const float* scores;
  int num_customers;
  const float* best;
  const int* candidates;
  float* gains;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const float* own =
        scores + static_cast<int64_t>(candidates[item]) * num_customers;
    const float gain =
        team.template Accumulate<float>(num_customers, [&](int i, float* sum) {
          const float difference = own[i] - best[i];
          *sum += difference > 0.f ? difference : 0.f;
        });
    if (team.IsLeader()) {
      gains[item] = gain;
    }
  }
};

// The superpixels of all views, one after the other. Everything from here on is
// in the frame of the first camera, planes too.
class Customers {
 public:
  Customers(const std::vector<ObservedView>& views,
            const DiscoverPlanesOptions& options) {
    const Camera& reference = views[0].camera;
    const Eigen::Vector3d origin = reference.Center();
    for (const ObservedView& view : views) {
      const ViewEvidence& evidence = *view.evidence;
      const int number = static_cast<int>(frames_.size());
      frames_.push_back({reference.rotation * (view.camera.Center() - origin),
                         reference.rotation * view.camera.rotation.transpose(),
                         DisparityScale{0.f, evidence.error_per_depth}});
      for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
        const int begin = evidence.first_observation[k];
        const int end = evidence.first_observation[k + 1];
        double qualities = 0.0;
        for (int i = begin; i < end; ++i) {
          qualities += evidence.observations[i].quality;
        }
        views_.push_back(number);
        entries_.push_back(
            {evidence.observations.data() + begin,
             end - begin,
             std::min(static_cast<double>(evidence.mass[k]), options.max_mass),
             qualities});
      }
    }
  }

  int Count() const { return static_cast<int>(views_.size()); }
  // Of each customer.
  const std::vector<int>& Views() const { return views_; }
  int NumViews() const { return static_cast<int>(frames_.size()); }
  const Eigen::Vector3d& CameraCenter(int view) const {
    return frames_[view].center;
  }

  int NumObservations(int customer) const { return entries_[customer].count; }
  DepthObservation At(int customer, int number) const {
    const Entry& entry = entries_[customer];
    const Frame& frame = frames_[views_[customer]];
    const Observation& observed = entry.observations[number];
    const RayDepth& sample = observed.sample;
    DepthObservation observation;
    observation.center = frame.center;
    observation.ray = frame.rotation * Eigen::Vector3d(sample.x, sample.y, 1.0);
    observation.depth = sample.z;
    observation.sigma = static_cast<double>(sample.z) *
                        frame.scale.RelativeDepthError(sample.z);
    observation.weight = observed.quality * entry.mass / entry.qualities;
    return observation;
  }

 private:
  struct Frame {
    Eigen::Vector3d center;
    Eigen::Matrix3d rotation;  // From the view's camera.
    DisparityScale scale;
  };
  struct Entry {
    const Observation* observations;
    int count;
    double mass;
    double qualities;  // The sum of the observations'.
  };

  std::vector<Frame> frames_;
  std::vector<int> views_;
  std::vector<Entry> entries_;
};

// Scores planes for all customers on a device.
class Scorer {
 public:
  Scorer(const Customers& customers, double tolerance, Device& device)
      : num_customers_(customers.Count()),
        device_(&device),
        views_(device, customers.Views()) {
    for (int i = 0; i < customers.NumViews(); ++i) {
      centers_.push_back(customers.CameraCenter(i));
    }
    constexpr int kSize = ObservationBlock::kSize;
    std::vector<int> first_block = {0};
    for (int k = 0; k < num_customers_; ++k) {
      first_block.push_back(first_block.back() +
                            (customers.NumObservations(k) + kSize - 1) / kSize);
    }
    std::vector<ObservationBlock> blocks(first_block.back());
    std::vector<Ball> balls;
    for (int k = 0; k < num_customers_; ++k) {
      Eigen::AlignedBox3d box;
      double reach = 0.0;
      for (int i = 0; i < customers.NumObservations(k); ++i) {
        const DepthObservation observation = customers.At(k, i);
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
        box.extend(observation.Point());
        reach = std::max(reach, observation.sigma * tolerance * length);
      }
      balls.push_back(BallAround(box, kReachMargin * reach));
    }
    blocks_ = Buffer<ObservationBlock>(device, blocks);
    first_block_ = Buffer<int>(device, first_block);
    balls_ = Buffer<Ball>(device, balls);
  }

  int NumCustomers() const { return num_customers_; }

  // A row of scores per plane.
  Buffer<float> Score(const std::vector<WorldPlane>& planes) const {
    std::vector<Vec3f> normals;
    std::vector<float> offsets;
    std::vector<float> heights;
    for (const WorldPlane& plane : planes) {
      normals.push_back(ToVec3f(plane.normal));
      offsets.push_back(static_cast<float>(plane.offset));
      for (const Eigen::Vector3d& center : centers_) {
        heights.push_back(static_cast<float>(plane.Height(center)));
      }
    }
    const Buffer<Vec3f> device_normals(*device_, normals);
    const Buffer<float> device_offsets(*device_, offsets);
    const Buffer<float> device_heights(*device_, heights);
    Buffer<float> scores(*device_, planes.size() * num_customers_);
    const int64_t num_tiles = (num_customers_ + kTileSize - 1) / kTileSize;
    ParallelFor(*device_,
                num_tiles * static_cast<int64_t>(planes.size()),
                ScoreKernel{balls_.Data(),
                            blocks_.Data(),
                            first_block_.Data(),
                            views_.Data(),
                            num_customers_,
                            static_cast<int>(centers_.size()),
                            device_normals.Data(),
                            device_offsets.Data(),
                            device_heights.Data(),
                            static_cast<int>(planes.size()),
                            scores.Data()});
    return scores;
  }

 private:
  static Vec3f ToVec3f(const Eigen::Vector3d& vector) {
    const Eigen::Vector3f rounded = vector.cast<float>();
    return {rounded.x(), rounded.y(), rounded.z()};
  }

  // Holds the box and what is within reach of it; of no size where the box is
  // empty.
  static Ball BallAround(const Eigen::AlignedBox3d& box, double reach) {
    if (box.isEmpty()) {
      return {};
    }
    return {ToVec3f(box.center()),
            static_cast<float>(0.5 * box.diagonal().norm() + reach)};
  }

  std::vector<Eigen::Vector3d> centers_;  // Of the cameras.
  int num_customers_;
  Device* device_;
  Buffer<int> views_;
  Buffer<Ball> balls_;
  Buffer<ObservationBlock> blocks_;
  Buffer<int> first_block_;
};

// A plane with its score for each customer.
struct ScoredPlane {
  ScoredPlane() = default;
  ScoredPlane(const WorldPlane& plane, std::vector<float> scores)
      : plane(plane), scores(std::move(scores)) {
    for (size_t k = 0; k < this->scores.size(); ++k) {
      if (this->scores[k] > 0.f) {
        customers.push_back(static_cast<int>(k));
      }
    }
  }

  WorldPlane plane;
  std::vector<float> scores;
  // Those whose score is not 0: a few of all.
  std::vector<int> customers;
};

std::vector<ScoredPlane> ScorePlanes(const Scorer& scorer,
                                     const std::vector<WorldPlane>& planes) {
  const std::vector<float> scores = scorer.Score(planes).ToHost();
  std::vector<ScoredPlane> scored;
  auto row = scores.begin();
  for (const WorldPlane& plane : planes) {
    scored.emplace_back(plane,
                        std::vector<float>(row, row + scorer.NumCustomers()));
    row += scorer.NumCustomers();
  }
  return scored;
}

// Finds the candidate that raises the best scores most.
class CandidatePicker {
 public:
  struct Pick {
    int candidate = -1;
    float gain = 0.f;
  };

  CandidatePicker(const std::vector<WorldPlane>& candidates,
                  const Scorer& scorer,
                  Device& device)
      : num_customers_(scorer.NumCustomers()),
        device_(&device),
        scores_(scorer.Score(candidates)),
        best_(device, num_customers_),
        gains_(candidates.size(), std::numeric_limits<float>::infinity()),
        order_(candidates.size()) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  std::vector<float> Scores(int candidate) const {
    std::vector<float> scores(num_customers_);
    device_->CopyToHost(
        scores.data(),
        scores_.Data() + static_cast<size_t>(candidate) * num_customers_,
        scores.size() * sizeof(float));
    return scores;
  }

  // best must not be below that of the call before in any place. No gain is
  // then above what it was, also as computed, since rounding keeps the order of
  // numbers: once a gain exceeds the old ones of all candidates that are left,
  // these need not be computed anew.
  Pick Next(const std::vector<float>& best) {
    best_.Upload(best.data());
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
      return gains_[a] != gains_[b] ? gains_[a] > gains_[b] : a < b;
    });
    Pick pick;
    for (size_t begin = 0;
         begin < order_.size() && gains_[order_[begin]] >= pick.gain;
         begin += kGainBatch) {
      const size_t end = std::min(begin + kGainBatch, order_.size());
      UpdateGains({order_.begin() + begin, order_.begin() + end});
      for (size_t i = begin; i < end; ++i) {
        const int candidate = order_[i];
        if (gains_[candidate] > pick.gain ||
            (gains_[candidate] == pick.gain && candidate < pick.candidate)) {
          pick = {candidate, gains_[candidate]};
        }
      }
    }
    return pick;
  }

 private:
  void UpdateGains(const std::vector<int>& candidates) {
    const Buffer<int> device_candidates(*device_, candidates);
    Buffer<float> device_gains(*device_, candidates.size());
    ParallelForTeams<128>(*device_,
                          static_cast<int64_t>(candidates.size()),
                          GainKernel{scores_.Data(),
                                     num_customers_,
                                     best_.Data(),
                                     device_candidates.Data(),
                                     device_gains.Data()});
    const std::vector<float> gains = device_gains.ToHost();
    for (size_t i = 0; i < candidates.size(); ++i) {
      gains_[candidates[i]] = gains[i];
    }
  }

  int num_customers_;
  Device* device_;
  Buffer<float> scores_;
  Buffer<float> best_;
  std::vector<float> gains_;  // At the time when each was computed last.
  std::vector<int> order_;
};

// Calls add(observation) for an evenly spaced sample of the observations of
// some customers, and returns the size of the sample.
template <typename Function>
size_t SampleObservations(const Customers& customers,
                          const std::vector<int>& members,
                          size_t max_samples,
                          const Function& add) {
  size_t count = 0;
  for (const int k : members) {
    count += customers.NumObservations(k);
  }
  const size_t num_samples = std::min(count, max_samples);
  size_t num_added = 0;
  size_t num_before = 0;
  for (const int k : members) {
    const size_t own_count = customers.NumObservations(k);
    while (num_added < num_samples) {
      const size_t next = num_added * count / num_samples;
      if (next >= num_before + own_count) {
        break;
      }
      add(customers.At(k, static_cast<int>(next - num_before)));
      ++num_added;
    }
    num_before += own_count;
  }
  return num_samples;
}

// The best three planes of a customer; -1 and 0 where there are fewer.
struct Ranking {
  int planes[3] = {-1, -1, -1};
  float scores[3] = {0.f, 0.f, 0.f};

  void Offer(int plane, float score) {
    for (int i = 0; i < 3; ++i) {
      // Of equal ones, the first is in front.
      if (score > scores[i] || (score == scores[i] && plane < planes[i])) {
        std::swap(plane, planes[i]);
        std::swap(score, scores[i]);
      }
    }
  }

  // Whether that could be told from what is here: false where another plane
  // may now be among the best.
  bool ChangeScore(int plane, float score) {
    const bool is_safe = score > scores[2];
    int place = 0;
    while (place < 3 && planes[place] != plane) {
      ++place;
    }
    if (place == 3) {
      Offer(plane, score);
      return true;
    }
    for (; place < 2; ++place) {
      planes[place] = planes[place + 1];
      scores[place] = scores[place + 1];
    }
    planes[2] = -1;
    scores[2] = 0.f;
    Offer(plane, score);
    return is_safe;
  }

  // Of all planes but those.
  float BestWithout(int plane, int other_plane) const {
    int i = 0;
    while (i < 2 && (planes[i] == plane || planes[i] == other_plane)) {
      ++i;
    }
    return planes[i] == plane || planes[i] == other_plane ? 0.f : scores[i];
  }
};

std::vector<Ranking> Rank(const std::vector<ScoredPlane>& planes,
                          int num_customers) {
  std::vector<Ranking> rankings(num_customers);
  for (size_t p = 0; p < planes.size(); ++p) {
    for (const int k : planes[p].customers) {
      rankings[k].Offer(static_cast<int>(p), planes[p].scores[k]);
    }
  }
  return rankings;
}

// Follows the change of one plane.
void UpdateRankings(const std::vector<ScoredPlane>& planes,
                    int changed,
                    const ScoredPlane& before,
                    std::vector<Ranking>* rankings) {
  const ScoredPlane& plane = planes[changed];
  const auto update = [&](int k) {
    Ranking& ranking = (*rankings)[k];
    if (!ranking.ChangeScore(changed, plane.scores[k])) {
      ranking = {};
      for (size_t p = 0; p < planes.size(); ++p) {
        ranking.Offer(static_cast<int>(p), planes[p].scores[k]);
      }
    }
  };
  for (const int k : before.customers) {
    update(k);
  }
  for (const int k : plane.customers) {
    if (!(before.scores[k] > 0.f)) {
      update(k);
    }
  }
}

// By how much a plane would raise best(customer), the best scores without it.
template <typename Function>
double Gain(const ScoredPlane& plane, const Function& best) {
  double gain = 0.0;
  for (const int k : plane.customers) {
    gain += std::max(plane.scores[k] - best(k), 0.f);
  }
  return gain;
}

class Discovery {
 public:
  Discovery(const Customers& customers,
            const DiscoverPlanesOptions& options,
            Device& device)
      : customers_(customers),
        options_(options),
        device_(&device),
        scorer_(customers, options.tolerance, device) {}

  std::vector<ScoredPlane> Run(const std::vector<WorldPlane>& candidates) {
    ChooseCandidates(candidates);
    do {
      FitToServed();
    } while (DropAndMerge());
    if (options_.regular_directions) {
      AlignPlanes();
    }
    return std::move(planes_);
  }

 private:
  // What to do to the planes, and what it costs.
  struct Change {
    int dropped = -1;
    double loss = 0.0;
    // What takes the place of the dropped plane and of another one.
    int replaced = -1;
    const ScoredPlane* joint = nullptr;
  };

  // Fits to the customers of two planes, from either plane on; none where they
  // are too different.
  using Joint = std::vector<ScoredPlane>;

  // What would be lost without some planes.
  struct Losses {
    explicit Losses(size_t num_planes)
        : without(num_planes, 0.0),
          more_without_both(num_planes, std::vector<double>(num_planes, 0.0)) {}

    // Without both of two different planes.
    double WithoutBoth(int a, int b) const {
      return without[a] + without[b] + more_without_both[a][b] +
             more_without_both[b][a];
    }

    std::vector<double> without;
    // By the best plane of customers and the second best.
    std::vector<std::vector<double>> more_without_both;
  };

  FitSamples Sample(const std::vector<int>& members, size_t max_samples) const {
    FitSamples samples;
    SampleObservations(
        customers_, members, max_samples, [&](const DepthObservation& sample) {
          samples.Add(sample);
        });
    return samples;
  }

  WorldPlane Fit(const WorldPlane& initial, const FitSamples& samples) const {
    return FitPlane(initial, samples, kCauchyShare * options_.tolerance);
  }

  void ChooseCandidates(const std::vector<WorldPlane>& candidates) {
    CandidatePicker picker(candidates, scorer_, *device_);
    std::vector<float> best(customers_.Count(), 0.f);
    while (static_cast<int>(planes_.size()) < options_.max_planes) {
      const CandidatePicker::Pick pick = picker.Next(best);
      if (pick.candidate < 0 || pick.gain < options_.min_gain) {
        break;
      }
      planes_.push_back(ImproveByFits(
          {candidates[pick.candidate], picker.Scores(pick.candidate)}, best));
      for (const int k : planes_.back().customers) {
        best[k] = std::max(best[k], planes_.back().scores[k]);
      }
    }
  }

  // Fits a plane to the customers that it would win.
  ScoredPlane ImproveByFits(ScoredPlane plane,
                            const std::vector<float>& best) const {
    const auto best_of = [&](int k) { return best[k]; };
    double gain = Gain(plane, best_of);
    for (int i = 0; i < kNumFirstFits; ++i) {
      std::vector<int> won;
      for (const int k : plane.customers) {
        if (plane.scores[k] > best[k]) {
          won.push_back(k);
        }
      }
      ScoredPlane fitted = std::move(ScorePlanes(
          scorer_, {Fit(plane.plane, Sample(won, kMaxFittedObservations))})[0]);
      const double fitted_gain = Gain(fitted, best_of);
      if (!(fitted_gain > gain)) {
        break;
      }
      plane = std::move(fitted);
      gain = fitted_gain;
    }
    return plane;
  }

  // The customers of each plane.
  std::vector<std::vector<int>> Members(
      const std::vector<Ranking>& rankings) const {
    std::vector<std::vector<int>> members(planes_.size());
    for (int k = 0; k < customers_.Count(); ++k) {
      if (rankings[k].planes[0] >= 0) {
        members[rankings[k].planes[0]].push_back(k);
      }
    }
    return members;
  }

  // Fits the planes to the customers that they serve and keeps what raises the
  // sum of the best scores.
  void FitToServed() {
    const int num_planes = static_cast<int>(planes_.size());
    bool improved = true;
    for (int round = 0; round < kMaxImprovingRounds && improved; ++round) {
      improved = false;
      std::vector<Ranking> rankings = Rank(planes_, customers_.Count());
      const std::vector<std::vector<int>> members = Members(rankings);
      std::vector<WorldPlane> fits(num_planes);
      device_->Threads().Run(num_planes, [&](int64_t begin, int64_t end) {
        for (int64_t p = begin; p < end; ++p) {
          fits[p] =
              Fit(planes_[p].plane, Sample(members[p], kMaxFittedObservations));
        }
      });
      std::vector<ScoredPlane> fitted = ScorePlanes(scorer_, fits);
      for (int p = 0; p < num_planes; ++p) {
        const auto best_of_others = [&](int k) {
          return rankings[k].BestWithout(p, p);
        };
        if (Gain(fitted[p], best_of_others) >
            Gain(planes_[p], best_of_others)) {
          std::swap(planes_[p], fitted[p]);
          UpdateRankings(planes_, p, fitted[p], &rankings);
          improved = true;
        }
      }
    }
  }

  // While there are planes that are not worth their cost. Returns whether there
  // were any.
  bool DropAndMerge() {
    joints_.clear();
    ids_.resize(planes_.size());
    std::iota(ids_.begin(), ids_.end(), 0);
    int next_id = static_cast<int>(planes_.size());
    bool changed = false;
    while (std::optional<Change> change = CheapestChange()) {
      if (change->replaced >= 0) {
        planes_[change->replaced] = ScoredPlane(*change->joint);
        ids_[change->replaced] = next_id++;
      }
      planes_.erase(planes_.begin() + change->dropped);
      ids_.erase(ids_.begin() + change->dropped);
      changed = true;
    }
    return changed;
  }

  // Nothing where no change costs less than a plane.
  std::optional<Change> CheapestChange() {
    const std::vector<Ranking> rankings = Rank(planes_, customers_.Count());
    const int num_planes = static_cast<int>(planes_.size());
    Losses losses(planes_.size());
    for (const Ranking& ranking : rankings) {
      const int best = ranking.planes[0];
      if (best < 0) {
        continue;
      }
      losses.without[best] += ranking.scores[0] - ranking.scores[1];
      if (ranking.planes[1] >= 0) {
        losses.more_without_both[best][ranking.planes[1]] +=
            ranking.scores[1] - ranking.scores[2];
      }
    }
    std::optional<Change> cheapest;
    const auto consider = [&](const Change& change) {
      if (change.loss < (cheapest ? cheapest->loss : options_.min_gain)) {
        cheapest = change;
      }
    };
    for (int p = 0; p < num_planes; ++p) {
      consider({p, losses.without[p], -1, nullptr});
    }
    const std::vector<std::vector<int>> members = Members(rankings);
    for (int a = 0; a < num_planes; ++a) {
      for (int b = a + 1; b < num_planes; ++b) {
        if (std::min(losses.without[a], losses.without[b]) <=
            kHopelessGains * options_.min_gain) {
          consider(Merge(a, b, losses.WithoutBoth(a, b), members, rankings));
        }
      }
    }
    return cheapest;
  }

  // Whether at least half of what some customers observe is within the largest
  // distance for merging.
  bool IsNear(const WorldPlane& plane, const std::vector<int>& members) const {
    size_t num_near = 0;
    const size_t num_samples = SampleObservations(
        customers_,
        members,
        kNumMergeSamples,
        [&](const DepthObservation& sample) {
          num_near += std::abs(NormalizedResidual(plane, sample)) <
                      kMaxMergeDistance * options_.tolerance;
        });
    return 2 * num_near >= num_samples;
  }

  // The fits are kept until one of the planes changes, though both may win or
  // lose some customers: there are hundreds of pairs, and nearly all of them
  // are looked at again after each change.
  const Joint& FindJoint(int a,
                         int b,
                         const std::vector<std::vector<int>>& members) {
    const auto [entry, is_new] = joints_.try_emplace({ids_[a], ids_[b]});
    Joint& joint = entry->second;
    const WorldPlane& plane_a = planes_[a].plane;
    const WorldPlane& plane_b = planes_[b].plane;
    if (is_new &&
        std::abs(plane_a.normal.dot(plane_b.normal)) >= kMinMergeCosine &&
        (IsNear(plane_a, members[b]) || IsNear(plane_b, members[a]))) {
      std::vector<int> both;
      std::merge(members[a].begin(),
                 members[a].end(),
                 members[b].begin(),
                 members[b].end(),
                 std::back_inserter(both));
      const FitSamples samples = Sample(both, kMaxFittedObservations);
      joint =
          ScorePlanes(scorer_, {Fit(plane_a, samples), Fit(plane_b, samples)});
    }
    return joint;
  }

  // By the better one of the two fits.
  Change Merge(int a,
               int b,
               double loss_without_both,
               const std::vector<std::vector<int>>& members,
               const std::vector<Ranking>& rankings) {
    Change change{b, std::numeric_limits<double>::infinity(), a, nullptr};
    for (const ScoredPlane& fit : FindJoint(a, b, members)) {
      const double loss = loss_without_both - Gain(fit, [&](int k) {
                            return rankings[k].BestWithout(a, b);
                          });
      if (loss < change.loss) {
        change.loss = loss;
        change.joint = &fit;
      }
    }
    return change;
  }

  // Makes planes regular where that costs little of what they serve.
  void AlignPlanes() {
    const std::vector<Ranking> rankings = Rank(planes_, customers_.Count());
    const std::vector<std::vector<int>> members = Members(rankings);
    std::vector<MeasuredPlane> measured;
    for (size_t p = 0; p < planes_.size(); ++p) {
      double support = 0.0;
      for (const int k : members[p]) {
        support += rankings[k].scores[0];
      }
      measured.push_back({planes_[p].plane,
                          support,
                          Sample(members[p], kMaxAlignedObservations)});
    }
    const auto is_acceptable = [&](int p, const WorldPlane& plane) {
      const auto best_of_others = [&](int k) {
        return rankings[k].BestWithout(p, p);
      };
      const ScoredPlane scored = std::move(ScorePlanes(scorer_, {plane})[0]);
      const double loss =
          Gain(planes_[p], best_of_others) - Gain(scored, best_of_others);
      return loss <= std::max(options_.min_gain,
                              kMaxAlignmentLoss * measured[p].support);
    };
    const std::vector<WorldPlane> regular =
        MakeRegular(measured, kCauchyShare * options_.tolerance, is_acceptable);
    planes_ = ScorePlanes(scorer_, regular);
  }

  const Customers& customers_;
  DiscoverPlanesOptions options_;
  Device* device_;
  Scorer scorer_;
  std::vector<ScoredPlane> planes_;
  // For DropAndMerge: a number for each plane, another one after each change of
  // it, and the joint fits by those of the two planes.
  std::vector<int> ids_;
  std::map<std::pair<int, int>, Joint> joints_;
};

WorldPlane FromWorld(const WorldPlane& plane, const Camera& reference) {
  return {reference.rotation * plane.normal, plane.Height(reference.Center())};
}

WorldPlane ToWorld(const WorldPlane& plane, const Camera& reference) {
  const Eigen::Vector3d normal = reference.rotation.transpose() * plane.normal;
  return {normal, plane.offset - normal.dot(reference.Center())};
}

}  // namespace

DiscoveredPlanes DiscoverPlanes(const std::vector<ObservedView>& views,
                                const std::vector<WorldPlane>& candidates,
                                const DiscoverPlanesOptions& options,
                                Device& device) {
  DiscoveredPlanes result;
  for (const ObservedView& view : views) {
    result.serving.emplace_back(view.evidence->NumSuperpixels(), -1);
  }
  if (views.empty()) {
    return result;
  }
  const Customers customers(views, options);
  if (customers.Count() == 0) {
    return result;
  }
  const Camera& reference = views[0].camera;
  std::vector<WorldPlane> local_candidates;
  const size_t max_candidates = options.max_scores / customers.Count();
  for (size_t i = 0; i < std::min(candidates.size(), max_candidates); ++i) {
    local_candidates.push_back(FromWorld(candidates[i], reference));
  }
  const std::vector<ScoredPlane> planes =
      Discovery(customers, options, device).Run(local_candidates);

  const std::vector<Ranking> rankings = Rank(planes, customers.Count());
  std::vector<double> supports(planes.size(), 0.0);
  for (const Ranking& ranking : rankings) {
    if (ranking.planes[0] >= 0) {
      supports[ranking.planes[0]] += ranking.scores[0];
    }
  }
  std::vector<int> order(planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return supports[a] > supports[b];
  });
  std::vector<int> places(planes.size());
  for (size_t i = 0; i < order.size(); ++i) {
    places[order[i]] = static_cast<int>(i);
    result.planes.push_back(
        {ToWorld(planes[order[i]].plane, reference), supports[order[i]]});
  }
  int customer = 0;
  for (std::vector<int>& of_view : result.serving) {
    for (int& plane : of_view) {
      const int found = rankings[customer++].planes[0];
      plane = found >= 0 ? places[found] : -1;
    }
  }
  return result;
}

}  // namespace tsar
