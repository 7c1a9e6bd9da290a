// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/merge_planes.h"

#include "colmap_tsar/scene/discovery/plane_ranking.h"
#include "colmap_tsar/view/planes/depth_observation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// Planes at a larger angle are never merged.
constexpr double kMinMergeCosine = 0.866;  // 30 degrees
// A pair is not fitted if the loss without either of its planes exceeds this
// multiple of the limit for the merge: a joint plane hardly makes up for that.
constexpr double kHopelessGains = 3.0;
// The number of observations by which the distance of planes is measured.
constexpr size_t kNumMergeSamples = 100;

// A change of the planes, and its loss.
struct Change {
  int dropped = -1;
  double loss = 0.0;
  double max_loss = 0.0;
  // The other plane of a merge, and the joint plane that replaces both.
  int replaced = -1;
  const ScoredPlane* joint = nullptr;

  // The ratio of the loss to its limit.
  double Share() const { return loss / max_loss; }
};

// Fits to the superpixels of two planes, initialized with either plane; none
// where they are too different.
using Joint = std::vector<ScoredPlane>;

// The loss of score without some planes.
struct Losses {
  explicit Losses(size_t num_planes)
      : without(num_planes, 0.0),
        more_without_both(num_planes, std::vector<double>(num_planes, 0.0)) {}

  // The loss without two different planes.
  double WithoutBoth(int a, int b) const {
    return without[a] + without[b] + more_without_both[a][b] +
           more_without_both[b][a];
  }

  std::vector<double> without;
  // The further loss, by the best and the second-best plane of superpixels.
  std::vector<std::vector<double>> more_without_both;
};

// Two planes that one might replace, and the limit of the loss.
struct Pair {
  int a = 0;
  int b = 0;
  double max_loss = 0.0;
};

// Votes of views on each other's planes. The matches of a superpixel
// (SuperpixelMatches) vote by their assigned planes; those without one do not
// vote. Views agree on a real surface. A copy of one comes from matching
// errors, which differ between views: where one view assigns a superpixel to
// the copy, others assign it to the surface.
class VotesOfViews {
 public:
  VotesOfViews(const SuperpixelMatches& matches,
               const std::vector<Ranking>& rankings,
               int num_planes,
               ThreadPool& threads)
      : num_planes_(num_planes),
        agreements_(rankings.size(), 1.f),
        counts_(static_cast<size_t>(num_planes) * num_planes, 0) {
    std::vector<int> assigned(rankings.size());
    std::transform(rankings.begin(),
                   rankings.end(),
                   assigned.begin(),
                   [](const Ranking& ranking) { return ranking.planes[0]; });
    std::mutex mutex;
    threads.Run(static_cast<int64_t>(rankings.size()),
                [&](int64_t begin, int64_t end) {
                  std::vector<int> counts(counts_.size(), 0);
                  for (auto k = static_cast<int>(begin); k < end; ++k) {
                    Count(matches, assigned, k, &counts);
                  }
                  const std::lock_guard lock(mutex);
                  for (size_t i = 0; i < counts.size(); ++i) {
                    counts_[i] += counts[i];
                  }
                });
  }

  // The share of the votes on a superpixel for its own plane; 1 without votes.
  float Agreement(int superpixel) const { return agreements_[superpixel]; }

  // The share of the votes on a plane's superpixels for the other plane, among
  // the votes for either; near 0 with few votes.
  double Confusion(int plane, int other) const {
    const int for_other = At(plane, other);
    return for_other / (kFewVotes + At(plane, plane) + for_other);
  }

 private:
  // Number of votes for the plane itself that are added as a prior.
  static constexpr double kFewVotes = 4.0;

  int At(int plane, int other) const {
    return counts_[static_cast<size_t>(plane) * num_planes_ + other];
  }

  void Count(const SuperpixelMatches& matches,
             const std::vector<int>& assigned,
             int superpixel,
             std::vector<int>* counts) {
    const int plane = assigned[superpixel];
    if (plane < 0) {
      return;
    }
    int num_votes = 0;
    int num_own = 0;
    for (const int match : matches.Of(superpixel)) {
      const int other = assigned[match];
      if (other >= 0) {
        ++(*counts)[static_cast<size_t>(plane) * num_planes_ + other];
        ++num_votes;
        num_own += other == plane ? 1 : 0;
      }
    }
    if (num_votes > 0) {
      agreements_[superpixel] =
          static_cast<float>(num_own) / static_cast<float>(num_votes);
    }
  }

  int num_planes_;
  std::vector<float> agreements_;  // Of each superpixel.
  // Numbers of votes by the plane of the superpixel, then by that of the vote.
  std::vector<int> counts_;
};

class PlaneMerger {
 public:
  PlaneMerger(const SuperpixelPlaneFitter& fitter,
              const SuperpixelMatches& matches,
              double min_gain,
              ThreadPool& threads,
              std::vector<ScoredPlane>* planes)
      : fitter_(fitter),
        matches_(matches),
        min_gain_(min_gain),
        threads_(threads),
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
  // The change with the smallest ratio of loss to limit; nothing where all
  // exceed their limits.
  std::optional<Change> CheapestChange() {
    const std::vector<Ranking> rankings =
        Rank(planes_, fitter_.Observations().Count(), threads_);
    const int num_planes = static_cast<int>(planes_.size());
    const VotesOfViews votes(matches_, rankings, num_planes, threads_);
    Losses losses(planes_.size());
    std::vector<double> agreed_losses(planes_.size(), 0.0);
    for (size_t k = 0; k < rankings.size(); ++k) {
      const Ranking& ranking = rankings[k];
      const int best = ranking.planes[0];
      if (best < 0) {
        continue;
      }
      const float loss = ranking.scores[0] - ranking.scores[1];
      losses.without[best] += loss;
      agreed_losses[best] += loss * votes.Agreement(static_cast<int>(k));
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
      consider({p, agreed_losses[p], min_gain_, -1, nullptr});
    }
    const std::vector<std::vector<int>> members =
        AssignedSuperpixels(rankings, planes_.size());
    std::vector<Pair> pairs;
    for (int a = 0; a < num_planes; ++a) {
      for (int b = a + 1; b < num_planes; ++b) {
        const int smaller = supports[a] < supports[b] ? a : b;
        const double confusion = votes.Confusion(smaller, a + b - smaller);
        const double max_loss =
            std::max(min_gain_, confusion * confusion * supports[smaller]);
        if (std::min(losses.without[a], losses.without[b]) <=
            kHopelessGains * max_loss) {
          pairs.push_back({a, b, max_loss});
        }
      }
    }
    FindJoints(pairs, members);
    std::vector<Change> merges(pairs.size());
    threads_.ForEach(pairs.size(), [&](size_t i) {
      merges[i] =
          Merge(pairs[i], losses.WithoutBoth(pairs[i].a, pairs[i].b), rankings);
    });
    for (const Change& merge : merges) {
      consider(merge);
    }
    return cheapest;
  }

  // Whether at least half of the observations of some superpixels are within
  // the largest distance for merging.
  bool IsNear(const WorldPlane& plane, const std::vector<int>& members) const {
    size_t num_near = 0;
    const size_t num_samples = fitter_.Observations().Sample(
        members, kNumMergeSamples, [&](const DepthObservation& sample) {
          num_near += std::abs(NormalizedResidual(plane, sample)) <
                      kMaxMergeDistance * fitter_.Tolerance();
        });
    return 2 * num_near >= num_samples;
  }

  // The fits are cached until one of the planes changes, though both may gain
  // or lose some superpixels: there are hundreds of pairs, and nearly all of
  // them are considered again after each change.
  void FindJoints(const std::vector<Pair>& pairs,
                  const std::vector<std::vector<int>>& members) {
    std::vector<Pair> added;
    std::vector<Joint*> joints;
    for (const Pair& pair : pairs) {
      const auto [entry, is_new] =
          joints_.try_emplace({ids_[pair.a], ids_[pair.b]});
      if (is_new) {
        added.push_back(pair);
        joints.push_back(&entry->second);
      }
    }
    std::vector<std::vector<WorldPlane>> fits(added.size());
    threads_.ForEach(added.size(),
                     [&](size_t i) { fits[i] = FitBoth(added[i], members); });
    ScoreJoints(fits, joints);
  }

  // Scores several pairs at a time: one is too little work for many threads.
  void ScoreJoints(const std::vector<std::vector<WorldPlane>>& fits,
                   const std::vector<Joint*>& joints) const {
    std::vector<WorldPlane> planes;
    std::vector<Joint*> owners;
    for (size_t i = 0; i < fits.size(); ++i) {
      planes.insert(planes.end(), fits[i].begin(), fits[i].end());
      owners.insert(owners.end(), fits[i].size(), joints[i]);
      if (planes.size() + 2 <= size_t{kMaxJointFits} && i + 1 < fits.size()) {
        continue;
      }
      std::vector<ScoredPlane> scored = fitter_.Score(planes);
      for (size_t k = 0; k < scored.size(); ++k) {
        owners[k]->push_back(std::move(scored[k]));
      }
      planes.clear();
      owners.clear();
    }
  }

  // The fits from both planes; none where the planes are too different.
  std::vector<WorldPlane> FitBoth(
      const Pair& pair, const std::vector<std::vector<int>>& members) const {
    const WorldPlane& plane_a = planes_[pair.a].plane;
    const WorldPlane& plane_b = planes_[pair.b].plane;
    const std::vector<int>& members_a = members[pair.a];
    const std::vector<int>& members_b = members[pair.b];
    if (!MayBeMerged(plane_a, plane_b) ||
        !(IsNear(plane_a, members_b) || IsNear(plane_b, members_a))) {
      return {};
    }
    std::vector<int> both;
    std::merge(members_a.begin(),
               members_a.end(),
               members_b.begin(),
               members_b.end(),
               std::back_inserter(both));
    const FitSamples samples = fitter_.Sample(both);
    return {fitter_.Fit(plane_a, samples), fitter_.Fit(plane_b, samples)};
  }

  // The merge by the better of the two fits.
  Change Merge(const Pair& pair,
               double loss_without_both,
               const std::vector<Ranking>& rankings) const {
    Change change{pair.b,
                  std::numeric_limits<double>::infinity(),
                  pair.max_loss,
                  pair.a,
                  nullptr};
    for (const ScoredPlane& fit : joints_.at({ids_[pair.a], ids_[pair.b]})) {
      const double loss = loss_without_both - PlaneGain(fit, [&](int k) {
                            return rankings[k].BestWithout(pair.a, pair.b);
                          });
      if (loss < change.loss) {
        change.loss = loss;
        change.joint = &fit;
      }
    }
    return change;
  }

  const SuperpixelPlaneFitter& fitter_;
  const SuperpixelMatches& matches_;
  double min_gain_;
  ThreadPool& threads_;
  std::vector<ScoredPlane>& planes_;
  // An id for each plane, renewed with each change of it, and the joint fits by
  // the ids of the two planes.
  std::vector<int> ids_;
  std::map<std::pair<int, int>, Joint> joints_;
};

}  // namespace

bool MayBeMerged(const WorldPlane& a, const WorldPlane& b) {
  return std::abs(a.normal.dot(b.normal)) >= kMinMergeCosine;
}

bool DropAndMergePlanes(const SuperpixelPlaneFitter& fitter,
                        const SuperpixelMatches& matches,
                        double min_gain,
                        ThreadPool& threads,
                        std::vector<ScoredPlane>* planes) {
  return PlaneMerger(fitter, matches, min_gain, threads, planes).Run();
}

}  // namespace tsar
