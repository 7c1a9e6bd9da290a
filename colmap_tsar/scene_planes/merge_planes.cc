// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/merge_planes.h"

#include "colmap_tsar/planes/depth_observation.h"
#include "colmap_tsar/scene_planes/plane_ranking.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// Planes at a larger angle are never merged.
constexpr double kMinMergeCosine = 0.866;  // 30 degrees
// The share of its support that the smaller of two planes may lose for the sake
// of one plane: what views measure of a surface differs by errors that each of
// them has in common with its neighbours, and two planes of one surface tear
// the views apart.
constexpr double kMaxMergeShare = 0.1;
// Nor are two planes each of which is worth more than this many times the cost
// of a plane where the other one stays: a joint plane hardly makes up for that.
constexpr double kHopelessGains = 3.0;
// By how many observations it is told how far planes are apart.
constexpr size_t kNumMergeSamples = 100;

// What to do to the planes, and what it costs.
struct Change {
  int dropped = -1;
  double loss = 0.0;
  double max_loss = 0.0;
  // What takes the place of the dropped plane and of another one.
  int replaced = -1;
  const ScoredPlane* joint = nullptr;

  // Of what it may cost.
  double Share() const { return loss / max_loss; }
};

// Fits to the superpixels of two planes, from either plane on; none where they
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
  // By the best plane of superpixels and the second best.
  std::vector<std::vector<double>> more_without_both;
};

class PlaneMerger {
 public:
  PlaneMerger(const SuperpixelPlaneFitter& fitter,
              double min_gain,
              std::vector<ScoredPlane>* planes)
      : fitter_(fitter),
        min_gain_(min_gain),
        planes_(*planes),
        ids_(planes->size()) {
    std::iota(ids_.begin(), ids_.end(), 0);
  }

  bool Run() {
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

 private:
  // In proportion to what it may cost; nothing where none is worth it.
  std::optional<Change> CheapestChange() {
    const std::vector<Ranking> rankings =
        Rank(planes_, fitter_.Observations().Count());
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
    std::vector<double> supports(planes_.size(), 0.0);
    for (const Ranking& ranking : rankings) {
      if (ranking.planes[0] >= 0) {
        supports[ranking.planes[0]] += ranking.scores[0];
      }
    }
    std::optional<Change> cheapest;
    const auto consider = [&](const Change& change) {
      if (change.Share() < (cheapest ? cheapest->Share() : 1.0)) {
        cheapest = change;
      }
    };
    for (int p = 0; p < num_planes; ++p) {
      consider({p, losses.without[p], min_gain_, -1, nullptr});
    }
    const std::vector<std::vector<int>> members =
        AssignedSuperpixels(rankings, planes_.size());
    for (int a = 0; a < num_planes; ++a) {
      for (int b = a + 1; b < num_planes; ++b) {
        const double max_loss =
            MaxMergeLoss(min_gain_, supports[a], supports[b]);
        if (std::min(losses.without[a], losses.without[b]) <=
            kHopelessGains * max_loss) {
          Change change =
              Merge(a, b, losses.WithoutBoth(a, b), members, rankings);
          change.max_loss = max_loss;
          consider(change);
        }
      }
    }
    return cheapest;
  }

  // Whether at least half of what some superpixels observe is within the
  // largest distance for merging.
  bool IsNear(const WorldPlane& plane, const std::vector<int>& members) const {
    size_t num_near = 0;
    const size_t num_samples = fitter_.Observations().Sample(
        members, kNumMergeSamples, [&](const DepthObservation& sample) {
          num_near += std::abs(NormalizedResidual(plane, sample)) <
                      kMaxMergeDistance * fitter_.Tolerance();
        });
    return 2 * num_near >= num_samples;
  }

  // The fits are kept until one of the planes changes, though both may win or
  // lose some superpixels: there are hundreds of pairs, and nearly all of them
  // are looked at again after each change.
  const Joint& FindJoint(int a,
                         int b,
                         const std::vector<std::vector<int>>& members) {
    const auto [entry, is_new] = joints_.try_emplace({ids_[a], ids_[b]});
    Joint& joint = entry->second;
    const WorldPlane& plane_a = planes_[a].plane;
    const WorldPlane& plane_b = planes_[b].plane;
    if (is_new && MayBeMerged(plane_a, plane_b) &&
        (IsNear(plane_a, members[b]) || IsNear(plane_b, members[a]))) {
      std::vector<int> both;
      std::merge(members[a].begin(),
                 members[a].end(),
                 members[b].begin(),
                 members[b].end(),
                 std::back_inserter(both));
      const FitSamples samples = fitter_.Sample(both);
      joint = fitter_.Score(
          {fitter_.Fit(plane_a, samples), fitter_.Fit(plane_b, samples)});
    }
    return joint;
  }

  // By the better one of the two fits.
  Change Merge(int a,
               int b,
               double loss_without_both,
               const std::vector<std::vector<int>>& members,
               const std::vector<Ranking>& rankings) {
    Change change{b, std::numeric_limits<double>::infinity(), 0.0, a, nullptr};
    for (const ScoredPlane& fit : FindJoint(a, b, members)) {
      const double loss = loss_without_both - PlaneGain(fit, [&](int k) {
                            return rankings[k].BestWithout(a, b);
                          });
      if (loss < change.loss) {
        change.loss = loss;
        change.joint = &fit;
      }
    }
    return change;
  }

  const SuperpixelPlaneFitter& fitter_;
  double min_gain_;
  std::vector<ScoredPlane>& planes_;
  // A number for each plane, another one after each change of it, and the
  // joint fits by those of the two planes.
  std::vector<int> ids_;
  std::map<std::pair<int, int>, Joint> joints_;
};

}  // namespace

double MaxMergeLoss(double min_gain, double support_a, double support_b) {
  return std::max(min_gain, kMaxMergeShare * std::min(support_a, support_b));
}

bool MayBeMerged(const WorldPlane& a, const WorldPlane& b) {
  return std::abs(a.normal.dot(b.normal)) >= kMinMergeCosine;
}

bool DropAndMergePlanes(const SuperpixelPlaneFitter& fitter,
                        double min_gain,
                        std::vector<ScoredPlane>* planes) {
  return PlaneMerger(fitter, min_gain, planes).Run();
}

}  // namespace tsar
