// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/discover_planes.h"

#include "colmap_tsar/scene/discovery/manhattan_frame.h"
#include "colmap_tsar/scene/discovery/merge_planes.h"
#include "colmap_tsar/scene/discovery/observation_table.h"
#include "colmap_tsar/scene/discovery/plane_ranking.h"
#include "colmap_tsar/scene/discovery/score_planes.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/scene/evidence/superpixel_matches.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// The share of its support that a plane may lose when it is aligned. It is not
// small, since views have errors in common.
constexpr double kMaxAlignmentLoss = 0.1;
// Fits are repeated while they improve planes, so that different ways lead to
// the same planes; this limit is hardly ever reached.
constexpr int kMaxImprovingRounds = 20;

class Discovery {
 public:
  Discovery(const PlaneScorer& scorer,
            const SuperpixelMatches& matches,
            const DiscoverPlanesOptions& options)
      : scorer_(scorer),
        matches_(matches),
        options_(options),
        num_superpixels_(scorer.Observations().Count()),
        threads_(scorer.GetDevice().Threads()) {}

  std::vector<ScoredPlane> Run(const std::vector<WorldPlane>& candidates) {
    ChooseCandidates(candidates, std::vector<float>(num_superpixels_, 0.f));
    do {
      FitToAssigned();
    } while (
        DropAndMergePlanes(scorer_, matches_, options_.min_gain, &planes_));
    if (options_.manhattan_frame) {
      AlignPlanes();
    }
    return std::move(planes_);
  }

  // The planes for superpixels that known planes explain poorly. best: the best
  // score of each superpixel so far.
  std::vector<ScoredPlane> Extend(const std::vector<WorldPlane>& candidates,
                                  const std::vector<float>& best) {
    ChooseCandidates(candidates, best);
    std::vector<std::vector<int>> members = AssignedSuperpixels(
        Rank(planes_, num_superpixels_, threads_), planes_.size());
    std::vector<WorldPlane> fits;
    for (size_t p = 0; p < planes_.size(); ++p) {
      const ScoredPlane& plane = planes_[p];
      std::erase_if(members[p],
                    [&](int k) { return plane.scores[k] <= best[k]; });
      fits.push_back(scorer_.Fit(plane.plane, scorer_.Sample(members[p])));
    }
    return scorer_.Score(fits);
  }

  // The frame to which planes were aligned.
  const std::optional<ManhattanFrame>& Frame() const { return frame_; }

 private:
  void ChooseCandidates(const std::vector<WorldPlane>& candidates,
                        std::vector<float> best) {
    LazyGreedySelection selection(candidates, scorer_);
    while (static_cast<int>(planes_.size()) < options_.max_planes) {
      const LazyGreedySelection::Choice choice = selection.Next(best);
      if (choice.candidate < 0 || choice.gain < options_.min_gain) {
        break;
      }
      planes_.emplace_back(candidates[choice.candidate],
                           selection.Scores(choice.candidate));
      for (const int k : planes_.back().superpixels) {
        best[k] = std::max(best[k], planes_.back().scores[k]);
      }
    }
  }

  // Fits the planes to their assigned superpixels and keeps the fits that raise
  // the sum of the best scores.
  void FitToAssigned() {
    const int num_planes = static_cast<int>(planes_.size());
    // The last fit of each plane, and the superpixels that it was fitted to;
    // none where the plane has changed since. Most stay from round to round.
    std::vector<ScoredPlane> fitted(planes_.size());
    std::vector<std::vector<int>> fitted_members(planes_.size());
    bool improved = true;
    for (int round = 0; round < kMaxImprovingRounds && improved; ++round) {
      improved = false;
      std::vector<Ranking> rankings = Rank(planes_, num_superpixels_, threads_);
      const std::vector<std::vector<int>> members =
          AssignedSuperpixels(rankings, planes_.size());
      std::vector<int> refitted;
      for (int p = 0; p < num_planes; ++p) {
        if (fitted[p].scores.empty() || fitted_members[p] != members[p]) {
          refitted.push_back(p);
        }
      }
      std::vector<WorldPlane> fits(refitted.size());
      threads_.ForEach(fits.size(), [&](size_t i) {
        const int p = refitted[i];
        fits[i] = scorer_.Fit(planes_[p].plane, scorer_.Sample(members[p]));
      });
      std::vector<ScoredPlane> scored = scorer_.Score(fits);
      for (size_t i = 0; i < scored.size(); ++i) {
        fitted[refitted[i]] = std::move(scored[i]);
        fitted_members[refitted[i]] = members[refitted[i]];
      }
      for (int p = 0; p < num_planes; ++p) {
        const auto best_of_others = [&](int k) {
          return rankings[k].BestWithout(p, p);
        };
        if (PlaneGain(fitted[p], best_of_others) >
            PlaneGain(planes_[p], best_of_others)) {
          planes_[p] = std::exchange(fitted[p], ScoredPlane());
          rankings = Rank(planes_, num_superpixels_, threads_);
          improved = true;
        }
      }
    }
  }

  // Aligns planes that lose little support by it.
  void AlignPlanes() {
    const std::vector<Ranking> rankings =
        Rank(planes_, num_superpixels_, threads_);
    const std::vector<std::vector<int>> members =
        AssignedSuperpixels(rankings, planes_.size());
    const std::vector<double> supports = Supports(rankings, planes_.size());
    std::vector<MeasuredPlane> measured;
    for (size_t p = 0; p < planes_.size(); ++p) {
      measured.push_back(
          {planes_[p].plane, supports[p], scorer_.Sample(members[p])});
    }
    const auto is_acceptable = [&](int p, const WorldPlane& plane) {
      const auto best_of_others = [&](int k) {
        return rankings[k].BestWithout(p, p);
      };
      const ScoredPlane scored = scorer_.ScoreOne(plane);
      const double loss = PlaneGain(planes_[p], best_of_others) -
                          PlaneGain(scored, best_of_others);
      return loss <=
             std::max(options_.min_gain, kMaxAlignmentLoss * supports[p]);
    };
    planes_ = scorer_.Score(AlignToManhattanFrame(
        measured, scorer_.LossScale(), is_acceptable, &frame_));
  }

  const PlaneScorer& scorer_;
  const SuperpixelMatches& matches_;
  const DiscoverPlanesOptions& options_;
  const int num_superpixels_;
  ThreadPool& threads_;
  std::vector<ScoredPlane> planes_;
  std::optional<ManhattanFrame> frame_;
};

WorldPlane FromWorld(const WorldPlane& plane, const Camera& reference) {
  return {reference.rotation * plane.normal, plane.Height(reference.Center())};
}

WorldPlane ToWorld(const WorldPlane& plane, const Camera& reference) {
  const Eigen::Vector3d normal = reference.rotation.transpose() * plane.normal;
  return {normal, plane.offset - normal.dot(reference.Center())};
}

// Adds planes that only priors observe, for superpixels that no measurement
// assigns to a plane. Planes of measurements are found first, without priors,
// which cannot distinguish planes that are as close as their errors.
// candidates: in the reference's frame.
void AddPlanesOfPriors(const std::vector<ObservedView>& views,
                       const std::vector<WorldPlane>& candidates,
                       const SuperpixelMatches& matches,
                       const DiscoverPlanesOptions& options,
                       Device& device,
                       DiscoveredPlanes* discovered) {
  if (std::ranges::all_of(views, [](const ObservedView& view) {
        return view.evidence->errors.empty();
      })) {
    return;
  }
  const Camera& reference = views[0].camera;
  const ObservationTable observations(views, ObservationsOf::kPriors);
  const PlaneScorer scorer(observations, options.tolerance, device);
  std::vector<WorldPlane> known;
  for (const ScenePlane& plane : discovered->planes) {
    known.push_back(FromWorld(plane.plane, reference));
  }
  std::vector<float> best(observations.Count(), 0.f);
  for (const ScoredPlane& plane : scorer.Score(known)) {
    for (const int k : plane.superpixels) {
      best[k] = std::max(best[k], plane.scores[k]);
    }
  }
  std::vector<int*> assigned;  // By superpixel of all views.
  for (std::vector<int>& of_view : discovered->assignment) {
    for (int& plane : of_view) {
      if (plane >= 0) {
        best[assigned.size()] = std::numeric_limits<float>::max();
      }
      assigned.push_back(&plane);
    }
  }
  for (const ScoredPlane& plane :
       Discovery(scorer, matches, options).Extend(candidates, best)) {
    const auto index = static_cast<int>(discovered->planes.size());
    double support = 0.0;
    for (const int k : plane.superpixels) {
      if (plane.scores[k] > best[k]) {
        best[k] = plane.scores[k];
        support += best[k];
        *assigned[k] = index;
      }
    }
    discovered->planes.push_back(
        {ToWorld(plane.plane, reference), support, -1});
  }
}

}  // namespace

std::vector<WorldPlane> CollectCandidates(
    const std::vector<ObservedView>& views) {
  std::vector<WorldPlane> candidates;
  for (const ObservedView& view : views) {
    for (const Plane& plane : view.evidence->candidates) {
      candidates.push_back(ToWorldPlane(plane, view.camera));
    }
  }
  return candidates;
}

DiscoveredPlanes DiscoverPlanes(const std::vector<ObservedView>& views,
                                const std::vector<WorldPlane>& candidates,
                                const DiscoverPlanesOptions& options,
                                Device& device) {
  DiscoveredPlanes result;
  for (const ObservedView& view : views) {
    result.assignment.emplace_back(view.evidence->NumSuperpixels(), kNoPlane);
  }
  if (views.empty()) {
    return result;
  }
  const ObservationTable observations(views);
  if (observations.Count() == 0) {
    return result;
  }
  const Camera& reference = views[0].camera;
  std::vector<WorldPlane> local_candidates;
  const size_t max_candidates = options.max_scores / observations.Count();
  for (size_t i = 0; i < std::min(candidates.size(), max_candidates); ++i) {
    local_candidates.push_back(FromWorld(candidates[i], reference));
  }
  const SuperpixelMatches matches(views);
  const PlaneScorer scorer(observations, options.tolerance, device);
  Discovery discovery(scorer, matches, options);
  const std::vector<ScoredPlane> planes = discovery.Run(local_candidates);
  const std::optional<ManhattanFrame>& frame = discovery.Frame();
  if (frame) {
    result.frame = reference.rotation.transpose() * frame->rotation;
  }

  const std::vector<Ranking> rankings =
      Rank(planes, observations.Count(), device.Threads());
  const std::vector<double> supports = Supports(rankings, planes.size());
  std::vector<int> order(planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(
      order, std::greater{}, [&](int p) { return supports[p]; });
  for (const int p : order) {
    result.planes.push_back({ToWorld(planes[p].plane, reference),
                             supports[p],
                             frame ? frame->axes[p] : -1});
  }
  const std::vector<int> new_indices = IndicesAmong(order, planes.size());
  int superpixel = 0;
  for (std::vector<int>& of_view : result.assignment) {
    for (int& plane : of_view) {
      plane = rankings[superpixel++].planes[0];
    }
    of_view = Renumber(std::move(of_view), new_indices);
  }
  AddPlanesOfPriors(views, local_candidates, matches, options, device, &result);
  return result;
}

}  // namespace tsar
