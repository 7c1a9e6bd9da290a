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

// A depth on its ray, in the camera's frame, and its confidence.
struct Observation {
  RayDepth sample;  // z > 0
  // Confidence in (0, 1]; above 1 where one observation represents many of a
  // prior.
  float confidence = 0.f;
};

// The source of the depth of an observation.
enum class ObservationSource : uint8_t {
  kRegionPlane = 0,  // The plane of the pixel's region.
  kMeasured = 1,     // A measurement of the view.
  kPrior = 2,        // A depth prior.
};

// Residuals of a prior up to one tolerance count as 0, and those of two in
// full: its errors are correlated over whole surfaces, and a plane that follows
// them should not be preferred.
constexpr float kSlackOfPrior = 1.f;

// The common border of two superpixels.
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

// The measurements of one view, as it and its neighbors need them to find the
// planes of the scene: small compared to its maps. Everything is on the raster
// of its superpixels and in its camera's frame.
struct ViewEvidence {
  int width = 0;  // Of the raster.
  int height = 0;
  // Intrinsics of the raster. They differ from those of the image, scaled to
  // its size, where the view was judged at a smaller size.
  Intrinsics intrinsics;
  // Resolution of the judged map, at the size at which it was judged.
  DepthResolution resolution;
  // Standard deviation of measurements at the planes of superpixels, in
  // relative depths of one pixel of disparity; 0 where no superpixel has a
  // plane.
  float noise = 0.f;

  Image<uint16_t> superpixels;  // Labels in [0, NumSuperpixels()).
  // Per superpixel, the sum of the confidences of all its pixels.
  std::vector<float> weights;
  // The observations of superpixel k, a sample of its pixels, are
  // first_observation[k] to first_observation[k + 1]. NumSuperpixels() + 1
  // entries.
  std::vector<int> first_observation;
  std::vector<Observation> observations;
  // The expected error of each observation, in relative depths of one pixel of
  // disparity; empty where all are 1, as without a prior.
  std::vector<float> errors;
  std::vector<ObservationSource> sources;  // Of each observation.
  // Depths that other views confirm and that the view itself did not trust, for
  // labeling but not for discovery of planes. Those of superpixel k are
  // first_confirmed[k] to first_confirmed[k + 1], a sample of its
  // confirmed_pixels[k] pixels with such a depth.
  std::vector<int> first_confirmed;
  std::vector<RayDepth> confirmed;
  std::vector<int> confirmed_pixels;

  std::vector<SuperpixelBorder> borders;  // Sorted by (first, second).

  // Candidate planes of the view alone: of regions, then of superpixels.
  std::vector<Plane> candidates;

  // Depths that are almost certain, 0 elsewhere: the space in front of them is
  // free.
  Image<float> confident_depth;

  // An external depth prior; may be empty.
  AlignedPrior prior;

  // The image from which the superpixels were made.
  Image<Rgb> color;

  // Its gray levels before it was denoised, for lines on planes: along these,
  // noise averages out.
  Image<uint8_t> gray;

  // A MeasurementFlags of each depth, of the size at which the view was
  // judged: that of the depth map, or of a reduced one.
  Image<uint8_t> flags;

  float ErrorOf(size_t observation) const {
    return errors.empty() ? 1.f : errors[observation];
  }
  bool IsOfPrior(size_t observation) const {
    return sources[observation] == ObservationSource::kPrior;
  }
  // Index of a superpixel's first observation of a prior; these come last.
  int FirstOfPrior(int superpixel) const;
  int NumSuperpixels() const { return static_cast<int>(weights.size()); }
};

// Removes the values and observations of a prior. Candidate planes, which
// measurements have to support, stay, and pixels at which the prior replaced
// the contradicting plane of their region have no observation. A prior in use
// gets the verdict kOthersUnlike.
void RemovePrior(ViewEvidence* evidence);

// The number of pixels of each superpixel.
std::vector<float> CountPixels(const ViewEvidence& evidence);

// The ray of each superpixel's center, in the camera's frame. intrinsics: of
// the raster.
std::vector<Vec3f> MiddleRays(const ViewEvidence& evidence,
                              const Intrinsics& intrinsics);

}  // namespace tsar
