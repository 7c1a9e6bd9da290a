// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene/graph_cut/label_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tsar {

// A number from kMin to kMax in 255 equal steps: the labels of all views of a
// scene are in memory at once.
template <int kMin, int kMax>
class ByteOf {
 public:
  static_assert(kMin <= 0 && kMax > kMin);

  ByteOf() : ByteOf(0.f) {}
  // Rounds, and clamps what lies outside.
  explicit ByteOf(float value)
      : level_(static_cast<uint8_t>(std::lround(
            (std::clamp(value, float{kMin}, float{kMax}) - kMin) * kScale))) {}

  float Value() const { return level_ / kScale + kMin; }

  friend bool operator==(const ByteOf&, const ByteOf&) = default;

 private:
  static constexpr float kScale = 255.f / (kMax - kMin);
  uint8_t level_;
};

// How well the plane that a superpixel was labelled with is borne out there.
struct LabelQuality {
  // What PlaneCost says of the superpixel on this plane.
  ByteOf<0, 1> strength;
  ByteOf<0, 1> confirmed;
  ByteOf<0, 1> uncertainty;
  // How much more the next best plane, or none, would cost, neighbours left
  // aside, in pixels of full confidence for each pixel of the superpixel;
  // negative where the neighbours decided.
  ByteOf<-1, 2> margin;

  friend bool operator==(const LabelQuality&, const LabelQuality&) = default;
};

// How much the labels of other views count. Costs are in pixels of the raster
// for each view of full weight, gaps in relative depths of one pixel of
// disparity.
struct LabelVoteOptions {
  // What a pixel gains by a view with the same plane there,
  float gain_of_same = 0.1f;
  // and costs by one with another plane that is this close at most. The cost
  // grows with the gap, up to full_gap.
  float cost_of_rival = 0.1f;
  float max_gap = 6.f;
  float full_gap = 0.5f;
  // What it costs to lie further than that in front of a view's plane, which it
  // would hide, and what to lie behind what several views see in front of it.
  float cost_of_hiding = 0.1f;
  float cost_of_hidden = 0.2f;
  // What a label weighs that nothing in its own view measured. One that all
  // measurements agree on weighs 1 (LabeledView::strengths).
  float guessed_weight = 0.2f;
  // More weight than this changes nothing; and no pixel costs more than this.
  float max_same = 3.f;
  float max_against = 3.f;
};

// Costs are in pixels of full confidence. Depth differences are in relative
// depths of one pixel of disparity.
struct LabelOptions {
  // From this difference on, an observation speaks fully against a plane.
  float tolerance = 1.f;
  // What an observation costs that no plane is to explain. A plane that
  // explains a superpixel's observations worse than this is none for it, unless
  // the neighbours outweigh that.
  float cost_of_unexplained = 0.6f;
  // What a depth off its plane costs that other views confirm and the view did
  // not trust: most of them are wrong on bare surfaces, but in numbers they
  // tell a chest from the wall behind it.
  float confirmed_weight = 0.2f;
  // LabeledView::strengths is half of what it is with many measurements where
  // they are this share of the pixels.
  float strength_prior = 0.02f;
  // Per pixel without an observation: of having no plane, and of having one
  // whose depth there is unknown.
  float unlabelled_cost = 0.02f;
  float uncertainty_cost = 0.05f;
  // The expected error of a plane at which its depth counts as unknown.
  float max_sigma = 1.f;
  // How unknown a plane's depth is where it was observed on one side only, far
  // from there.
  float extrapolation_uncertainty = 0.6f;
  // How far that is, relative to the size of the area in which the plane was
  // observed.
  float extrapolation_reach = 0.6f;
  // What a pixel without an observation costs whose region has other colours in
  // the other views: per full difference beyond that on the plane which fits
  // best, plus what noise and gloss make of it. Planes more uncertain than this
  // are none to compare with: one that nobody observed there fits by chance.
  float color_cost = 4.f;
  float min_color_gap = 0.05f;
  float max_color_uncertainty = 0.3f;
  // Within this share of the tolerance of what another view saw, a plane is
  // confirmed.
  float confirmation_share = 0.5f;
  // The gap between two planes at a border from which the border costs its full
  // weight.
  float full_gap = 3.f;
  LabelVoteOptions votes;
  ExpansionOptions expansion;
};

// How a superpixel came by its plane.
enum class LabelEvidence : uint8_t {
  kNone = 0,      // It has none.
  kGuessed = 1,   // By its neighbours in the image alone.
  kCarried = 2,   // Other views measured the plane there.
  kMeasured = 3,  // It lies in the superpixel's own observations.
};

// What each superpixel of a view was labelled with.
struct ViewLabels {
  std::vector<int> planes;  // Numbers of planes; -1: none.
  std::vector<LabelEvidence> evidence;
  // Of those that have a plane; all 0 elsewhere.
  std::vector<LabelQuality> qualities;
};

// What a view was labelled with, for the views that look at the same.
struct VotingLabels {
  std::vector<int> planes;       // As in ViewLabels.
  std::vector<float> strengths;  // See LabeledView.
};

struct LabeledView {
  // Planes of the scene, in the reference camera's frame.
  std::vector<Plane> planes;
  // Per superpixel of the reference: the number of its plane, or -1.
  std::vector<int> labels;
  std::vector<LabelEvidence> evidence;
  std::vector<LabelQuality> qualities;  // See ViewLabels.
  // How firmly the superpixel's measurements place it on its plane, from 0 to 1
  // (PlaneCost::strength).
  std::vector<float> strengths;
};

}  // namespace tsar
