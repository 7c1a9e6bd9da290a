// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/surfaces/curved_surfaces.h"
#include "colmap_tsar/scene/surfaces/surface_samples.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

namespace tsar {

// A superpixel of the reference in the search for curved surfaces.
struct Superpixel {
  int num_pixels = 0;
  SampleRange samples;         // In SurfaceCosts::Samples().
  SampleRange tests;           // In SurfaceCosts::Tests().
  std::vector<int> neighbors;  // Ascending.
  float confidence = 0.f;      // Sum over the samples.
  float weight = 0.f;          // Of measurements.
  // The residual with its plane or without any: see MeasuredFit::residual.
  float residual = 0.f;

  bool IsMeasured() const { return confidence > 0.f; }
};

// The fit of a surface to the measurements of a superpixel.
struct MeasuredFit {
  // Mean of min(difference / tolerance, 1)^2; 1 without samples.
  float residual = 1.f;
  // The range of inlier depths; min_depth > max_depth where there are none.
  float min_depth = INFINITY;
  float max_depth = 0.f;
};

// The costs of superpixels of the reference on surfaces, and with their present
// planes. Keeps references to the arguments. It caches residuals on planes and
// is not thread-safe.
class SurfaceCosts {
 public:
  // The arguments are those of FindCurvedSurfaces.
  SurfaceCosts(const std::vector<ObservedView>& views,
               const LabeledView& labeled,
               const CurvedSurfaceOptions& options);

  const CurvedSurfaceOptions& Options() const { return options_; }
  const DepthResolution& Resolution() const { return resolution_; }
  const DepthSamples& Samples() const { return samples_; }
  const RaySamples& Tests() const { return tests_; }
  int Count() const { return static_cast<int>(superpixels_.size()); }
  const Superpixel& At(int s) const { return superpixels_[s]; }
  // The mean of the rays of its pixels.
  Vec3f MiddleOf(int s) const;
  // The index of the superpixel's plane, or -1.
  int LabelOf(int s) const { return labeled_.labels[s]; }
  int NumPlanes() const { return static_cast<int>(labeled_.planes.size()); }
  // The number of measured superpixels of a plane.
  int NumMeasured(int plane) const { return num_measured_[plane]; }

  MeasuredFit Measure(const Superpixel& superpixel,
                      const CurvedSurface& surface) const;

  // The residual of a measured superpixel, each sample at the nearest of some
  // planes: none alone explains a superpixel in which planes intersect.
  float ResidualOfNearest(int s, const std::vector<int>& planes) const;

  // The cost of a superpixel with this residual (MeasuredFit); see
  // LabelOptions.
  float Cost(const Superpixel& superpixel, float residual) const {
    return superpixel.IsMeasured() ? superpixel.weight * residual : 0.f;
  }

  // The cost with its plane or without any.
  float PresentCost(int s) const;

  // Whether the superpixel lies in a region whose plane is another surface.
  bool OpposesRegion(int s, const CurvedSurface& surface) const;

  LabelEvidence EvidenceOf(const Superpixel& superpixel,
                           const CurvedSurface& surface) const;

 private:
  void MakeSuperpixels();
  void ListPixels();
  void AddSamples(int s, Superpixel* superpixel);
  void AddTests(int s, Superpixel* superpixel);
  // A plane converted to a surface.
  CurvedSurface PlaneSurface(int label) const;
  Vec3f RayOf(int pixel) const {
    return intrinsics_.Ray(pixel % evidence_.width, pixel / evidence_.width);
  }
  // The difference / tolerance of each sample of a superpixel on a plane.
  const std::vector<float>& FindShares(int s, int plane) const;
  SuperpixelVotes AskSources(const Superpixel& superpixel,
                             const CurvedSurface& surface) const;

  const ViewEvidence& evidence_;
  Intrinsics intrinsics_;
  DepthResolution resolution_;
  const LabeledView& labeled_;
  const CurvedSurfaceOptions& options_;
  std::vector<ObservedSource> sources_;
  std::vector<Superpixel> superpixels_;
  // The pixels of superpixel s in raster order are pixels_[first_pixel_[s]] to
  // pixels_[first_pixel_[s + 1]].
  std::vector<int> first_pixel_;
  std::vector<int> pixels_;
  DepthSamples samples_;
  RaySamples tests_;
  std::vector<int> num_measured_;  // Of each plane.
  // Cached shares per superpixel, by plane.
  mutable std::vector<std::map<int, std::vector<float>>> shares_;
};

}  // namespace tsar
