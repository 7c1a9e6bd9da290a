// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/priors/align_prior.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tsar {

// A depth with its own ray, in the camera's frame, and how far it is to be
// believed.
struct Observation {
  RayDepth sample;  // z > 0
  // In (0, 1]; above 1 where one observation stands for many of a prior.
  float confidence = 0.f;
};

// Where the depth of an observation comes from.
enum class ObservationSource : uint8_t {
  kRegionPlane = 0,  // The plane of the pixel's region.
  kMeasured = 1,     // What the view measured there.
  kPrior = 2,        // A depth prior.
};

// The errors of a prior are those of whole surfaces. So that no plane is
// preferred to another for following them, deviations up to the tolerance count
// as none, and those of one more tolerance in full.
constexpr float kSlackOfPrior = 1.f;

// Where two superpixels touch.
struct SuperpixelBorder {
  int first = 0;  // The smaller label.
  int second = 0;
  // Sum over the pairs of pixels across the border: high where the image has no
  // edge there, so that a change of surface is unlikely.
  float weight = 0.f;
  // Pixels of `first` along the border, evenly spaced; indices of the raster.
  // Short borders repeat some.
  static constexpr int kNumPixels = 4;
  int pixels[kNumPixels] = {};
};

// What one view measured, as it and its neighbours need it to find the planes
// of the scene: small next to its maps. Everything lives on the raster of its
// superpixels and in its camera's frame.
struct ViewEvidence {
  int width = 0;  // Of the raster.
  int height = 0;
  // Of the raster, with which everything here was made. Those of the image,
  // scaled to its size, are others where the view was judged at a smaller size.
  Intrinsics intrinsics;
  // Of the map that was judged, at the size at which it was.
  DepthResolution resolution;
  // Spread of the measurements about the planes of superpixels, in relative
  // depths of one pixel of disparity; 0 where no superpixel has a plane.
  float noise = 0.f;

  Image<uint16_t> superpixels;  // Labels in [0, NumSuperpixels()).
  // Per superpixel, the sum of the confidences of all its pixels.
  std::vector<float> weights;
  // Those of superpixel k are first_observation[k] to first_observation[k + 1]:
  // a sample of its pixels. NumSuperpixels() + 1 entries.
  std::vector<int> first_observation;
  std::vector<Observation> observations;
  // For each observation its expected error, in relative depths of one pixel of
  // disparity; empty where all are 1, as they are without a prior.
  std::vector<float> errors;
  std::vector<ObservationSource> sources;  // Of each observation.
  // What tells which plane a superpixel lies on, and not which planes there are:
  // depths that other views confirm and that the view itself did not trust.
  // Those of superpixel k are first_confirmed[k] to first_confirmed[k + 1]: a
  // sample of its pixels that have one, of which there are
  // confirmed_pixels[k].
  std::vector<int> first_confirmed;
  std::vector<RayDepth> confirmed;
  std::vector<int> confirmed_pixels;

  std::vector<SuperpixelBorder> borders;  // Sorted by (first, second).

  // Planes that the view found by itself: of regions, then of superpixels.
  std::vector<Plane> candidates;

  // Depths that are as good as certain, 0 elsewhere: what the view saw through
  // is empty up to there.
  Image<float> confident_depth;

  // From outside; empty without.
  AlignedPrior prior;

  // The image that the superpixels were made of.
  Image<Rgb> color;

  // A MeasurementRating of each depth, of the size at which the view was
  // judged: that of the depth map, or of a reduced one.
  Image<uint8_t> ratings;

  float ErrorOf(size_t observation) const {
    return errors.empty() ? 1.f : errors[observation];
  }
  bool IsOfPrior(size_t observation) const {
    return sources[observation] == ObservationSource::kPrior;
  }
  // A superpixel's observations of a prior are its last ones, from this on.
  int FirstOfPrior(int superpixel) const;
  int NumSuperpixels() const { return static_cast<int>(weights.size()); }
};

// Of each superpixel of the evidence, the number of its pixels,
std::vector<float> CountPixels(const ViewEvidence& evidence);

// and the ray of their middle, in the camera's frame. intrinsics: of the
// raster.
std::vector<Vec3f> MiddleRays(const ViewEvidence& evidence,
                              const Intrinsics& intrinsics);

}  // namespace tsar
