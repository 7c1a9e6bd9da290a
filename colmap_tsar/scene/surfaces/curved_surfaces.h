// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <vector>

namespace tsar {

struct CurvedSurfaceOptions {
  // Costs, tolerance and what other views say, as for planes.
  LabelOptions labels;
  // Only what was measured tells of curvature, not pixels on the plane of a
  // region: observations of lower confidence.
  float min_confidence = 0.4f;
  // Errors of neighbouring pixels are alike: so many pixels of full confidence
  // count as one observation, with a standard deviation of this share of the
  // tolerance.
  float pixels_per_observation = 250.f;
  float noise_share = 0.33f;
  // By how much the criterion must fall: 6 is called strong evidence.
  float min_gain = 6.f;
  // Less of a superpixel measured than this share does not tell whether a
  // surface holds there.
  float min_measured = 0.1f;
  // Mean of min(residual / tolerance, 1)^2 over all of a surface, and over one
  // of its superpixels, at most.
  float max_residual = 0.12f;
  float max_residual_of_superpixel = 0.5f;
  // By how much this mean must fall at least: errors that all of a surface has
  // in common, which no number of observations averages out, look like a slight
  // curvature.
  float min_improvement = 0.015f;
  // Fewer measured superpixels do not tell a curve from a wrong depth.
  int min_superpixels = 3;
  // While it grows, a surface may explain a superpixel so much worse than its
  // plane, by the same mean: it is still to be fitted there.
  float growth_slack = 0.1f;
  // How far the surface bends away from a plane over its extent, as a share of
  // its depth.
  float max_sagitta = 0.15f;
  // Cosine of the angle between normal and ray.
  float min_slope = 0.15f;
};

struct CurvedView {
  // In the reference camera's frame.
  std::vector<CurvedSurface> surfaces;
  // Per superpixel of the reference: the number of its surface, or -1 where it
  // keeps its plane or has neither.
  std::vector<int> labels;
  // Per superpixel: how it came by its surface, else by its plane.
  std::vector<LabelEvidence> evidence;
};

// Finds connected superpixels of the reference which one quadratic
// inverse-depth surface explains better than their planes, or none, do: in the
// sense of the Bayesian information criterion, which charges a surface for its
// six parameters and credits it with three for each plane that it replaces
// altogether. Surfaces fill superpixels without measurements only where
// measurements surround these and the fit is certain there.
// views: the reference, of which labeled tells, then those that look at the
// same scene.
CurvedView FindCurvedSurfaces(const std::vector<ObservedView>& views,
                              const LabeledView& labeled,
                              const CurvedSurfaceOptions& options);

}  // namespace tsar
