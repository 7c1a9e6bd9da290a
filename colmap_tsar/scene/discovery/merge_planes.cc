// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/merge_planes.h"

#include "colmap_tsar/scene/discovery/plane_ranking.h"
#include "colmap_tsar/view/planes/world_plane.h"

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

// The largest number of joint fits that are scored at a time.
constexpr size_t kMaxJointFits = 64;

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
               size_t num_planes,
               ThreadPool& threads)
      : num_planes_(num_planes), counts_(num_planes * num_planes, 0) {
    std::mutex mutex;
    threads.Run(static_cast<int64_t>(rankings.size()),
                [&](int64_t begin, int64_t end) {
                  std::vector<int> counts(counts_.size(), 0);
                  for (int64_t k = begin; k < end; ++k) {
                    Count(matches, rankings, static_cast<int>(k), &counts);
                  }
                  const std::lock_guard lock(mutex);
                  for (size_t i = 0; i < counts.size(); ++i) {
                    counts_[i] += counts[i];
                  }
                });
  }

  // The share of the votes on a plane's superpixels for the other plane, among
  // the votes for either; near 0 with few votes.
  double Confusion(int plane, int other) const {
    const int for_itself = counts_[plane * num_planes_ + plane];
    const int for_other = counts_[plane * num_planes_ + other];
    return for_other / (kFewVotes + for_itself + for_other);
  }

 private:
  // Number of votes for the plane itself that are added as a prior.
  static constexpr double kFewVotes = 4.0;

  void Count(const SuperpixelMatches& matches,
             const std::vector<Ranking>& rankings,
             int superpixel,
             std::vector<int>* counts) const {
    const int plane = rankings[superpixel].planes[0];
    if (plane < 0) {
      return;
    }
    for (const int match : matches.Of(superpixel)) {
      const int other = rankings[match].planes[0];
      if (other >= 0) {
        ++(*counts)[plane * num_planes_ + other];
      }
    }
  }

  size_t num_planes_;
  // Numbers of votes by the plane of the superpixel, then by that of the vote.
  std::vector<int> counts_;
};

// The loss of score without some planes.
struct Losses {
  Losses(const std::vector<Ranking>& rankings, size_t num_planes)
      : without(num_planes, 0.0),
        more_without_both(num_planes, std::vector<double>(num_planes, 0.0)) {
    for (const auto& [planes, scores] : rankings) {
      if (planes[0] >= 0) {
        without[planes[0]] += scores[0] - scores[1];
      }
      if (planes[1] >= 0) {
        more_without_both[planes[0]][planes[1]] += scores[1] - scores[2];
      }
    }
  }

  // The loss without two different planes.
  double WithoutBoth(int a, int b) const {
    return without[a] + without[b] + more_without_both[a][b] +
           more_without_both[b][a];
  }

  std::vector<double> without;
  // The further loss, by the best and the second-best plane of superpixels.
  std::vector<std::vector<double>> more_without_both;
};

class PlaneMerger {
 public:
  PlaneMerger(const PlaneScorer& scorer,
              const SuperpixelMatches& matches,
              double min_gain,
              std::vector<ScoredPlane>* planes)
      : scorer_(scorer),
        matches_(matches),
        min_gain_(min_gain),
        threads_(scorer.GetDevice().Threads()),
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
        Rank(planes_, scorer_.Observations().Count(), threads_);
    const VotesOfViews votes(matches_, rankings, planes_.size(), threads_);
    const Losses losses(rankings, planes_.size());
    std::optional<Change> cheapest;
    const auto consider = [&](const Change& change) {
      if (change.Share() < (cheapest ? cheapest->Share() : 1.0)) {
        cheapest = change;
      }
    };
    for (int p = 0; p < static_cast<int>(planes_.size()); ++p) {
      consider({p, losses.without[p], min_gain_});
    }
    const std::vector<Pair> pairs =
        FindPairs(losses.without, votes, Supports(rankings, planes_.size()));
    FindJoints(pairs, AssignedSuperpixels(rankings, planes_.size()));
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

  // The pairs of planes for which a merge is not hopeless.
  std::vector<Pair> FindPairs(const std::vector<double>& losses_without,
                              const VotesOfViews& votes,
                              const std::vector<double>& supports) const {
    const int num_planes = static_cast<int>(planes_.size());
    std::vector<Pair> pairs;
    for (int a = 0; a < num_planes; ++a) {
      for (int b = a + 1; b < num_planes; ++b) {
        const int smaller = supports[a] < supports[b] ? a : b;
        const double confusion = votes.Confusion(smaller, a + b - smaller);
        const double max_loss =
            std::max(min_gain_, confusion * confusion * supports[smaller]);
        if (std::min(losses_without[a], losses_without[b]) <=
            kHopelessGains * max_loss) {
          pairs.push_back({a, b, max_loss});
        }
      }
    }
    return pairs;
  }

  // Whether at least half of the observations of some superpixels are within
  // the largest distance for merging.
  bool IsNear(const WorldPlane& plane, const std::vector<int>& members) const {
    size_t num_near = 0;
    const size_t num_samples = scorer_.Observations().Sample(
        members, kNumMergeSamples, [&](const DepthObservation& sample) {
          num_near += std::abs(NormalizedResidual(plane, sample)) <
                      kMaxMergeDistance * scorer_.Tolerance();
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
    std::vector<WorldPlane> planes;
    std::vector<Joint*> owners;
    for (size_t i = 0; i < fits.size(); ++i) {
      planes.insert(planes.end(), fits[i].begin(), fits[i].end());
      owners.insert(owners.end(), fits[i].size(), joints[i]);
    }
    // Several pairs at a time: one is too little work for many threads.
    for (size_t begin = 0; begin < planes.size(); begin += kMaxJointFits) {
      const size_t end = std::min(begin + kMaxJointFits, planes.size());
      std::vector<ScoredPlane> scored =
          scorer_.Score({planes.begin() + begin, planes.begin() + end});
      for (size_t k = begin; k < end; ++k) {
        owners[k]->push_back(std::move(scored[k - begin]));
      }
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
    std::ranges::merge(members_a, members_b, std::back_inserter(both));
    const FitSamples samples = scorer_.Sample(both);
    return {scorer_.Fit(plane_a, samples), scorer_.Fit(plane_b, samples)};
  }

  // The merge by the better of the two fits.
  Change Merge(const Pair& pair,
               double loss_without_both,
               const std::vector<Ranking>& rankings) const {
    Change change{
        pair.b, std::numeric_limits<double>::infinity(), pair.max_loss, pair.a};
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

  const PlaneScorer& scorer_;
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

bool DropAndMergePlanes(const PlaneScorer& scorer,
                        const SuperpixelMatches& matches,
                        double min_gain,
                        std::vector<ScoredPlane>* planes) {
  return PlaneMerger(scorer, matches, min_gain, planes).Run();
}

}  // namespace tsar
