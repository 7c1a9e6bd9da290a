// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <vector>

namespace tsar {

struct CurvedSurfaceOptions {
  // Costs, tolerance and votes of other views, as for planes.
  LabelOptions labels;
  // The least confidence of observations that are used: those on the plane of a
  // region do not show curvature.
  float min_confidence = 0.4f;
  // Errors of neighbors are correlated: this many pixels of full confidence are
  // one observation, with a standard deviation of this share of the tolerance.
  float pixels_per_observation = 250.f;
  float noise_share = 0.33f;
  // The least decrease of the criterion: 6 is called strong evidence.
  float min_gain = 6.f;
  // The least measured share of a superpixel that counts as measured.
  float min_measured = 0.1f;
  // The largest mean of min(residual / tolerance, 1)^2 over a surface, and over
  // one of its superpixels.
  float max_residual = 0.12f;
  float max_residual_of_superpixel = 0.5f;
  // The least decrease of this mean: errors common to a whole surface, which no
  // number of observations averages out, look like a slight curvature.
  float min_improvement = 0.015f;
  // Fewer measured superpixels do not distinguish a curve from a wrong depth.
  int min_superpixels = 3;
  // While it grows, a surface's mean in a superpixel may be higher than that of
  // its plane by this, since it is yet to be fitted there.
  float growth_slack = 0.1f;
  // The largest deviation of the surface from a plane over its extent, relative
  // to its depth.
  float max_sagitta = 0.15f;
  // The least cosine of the angle between normal and ray.
  float min_slope = 0.15f;
};

struct CurvedView {
  // Surfaces in the reference camera's frame.
  std::vector<CurvedSurface> surfaces;
  // Per superpixel of the reference: the index of its surface, or -1 where it
  // keeps its plane or has neither.
  std::vector<int> labels;
  // Per superpixel: the evidence for its surface, else for its plane.
  std::vector<LabelEvidence> evidence;
};

// Finds connected superpixels of the reference which one quadratic
// inverse-depth surface explains better than their planes, or none, do: in the
// sense of the Bayesian information criterion, which charges a surface for its
// six parameters and credits it with three for each plane that it replaces
// altogether. Surfaces fill superpixels without measurements only where
// measurements surround these and the fit is certain there.
// views: the reference, which `labeled` belongs to, then its neighbors.
CurvedView FindCurvedSurfaces(const std::vector<ObservedView>& views,
                              const LabeledView& labeled,
                              const CurvedSurfaceOptions& options);

}  // namespace tsar
