// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/curved_surfaces.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/visibility_votes.h"

#include <cstddef>
#include <vector>

namespace tsar {

// A superpixel of the reference as a search for curved surfaces sees it.
struct Superpixel {
  std::vector<int> pixels;                // Of the raster.
  std::vector<Observation> observations;  // Those that were measured.
  std::vector<int> neighbors;             // Ascending.
  float confidence = 0.f;                 // Of the observations together.
  float weight = 0.f;                     // Of what was measured.
  Vec3f middle;                           // A ray.
  // With its plane or without any: what that costs, and Residual().
  float cost = 0.f;
  float residual = 0.f;

  bool IsMeasured() const { return confidence > 0.f; }
};

// What superpixels of the reference cost on surfaces, and with the planes that
// they have. Keeps references.
class SurfaceCosts {
 public:
  // As for FindCurvedSurfaces.
  SurfaceCosts(const std::vector<ObservedView>& views,
               const LabeledView& labeled,
               const CurvedSurfaceOptions& options);

  const CurvedSurfaceOptions& Options() const { return options_; }
  const DepthResolution& Resolution() const { return resolution_; }
  int Count() const { return static_cast<int>(superpixels_.size()); }
  const Superpixel& At(int s) const {
    return superpixels_[static_cast<size_t>(s)];
  }
  // The number of the superpixel's plane, or -1.
  int LabelOf(int s) const { return labeled_.labels[static_cast<size_t>(s)]; }
  int NumPlanes() const { return static_cast<int>(labeled_.planes.size()); }
  // A plane in the form of a surface.
  CurvedSurface PlaneSurface(int label) const;
  Vec3f RayOf(int pixel) const {
    return intrinsics_.Ray(static_cast<float>(pixel % evidence_.width),
                           static_cast<float>(pixel / evidence_.width));
  }

  // How far a depth that was measured is off the surface, in pixels of
  // disparity; infinite where the ray does not meet it.
  float Difference(const RayDepth& sample, const CurvedSurface& surface) const;

  // Mean of min(difference / tolerance, 1)^2; 1 without observations.
  float Residual(const Superpixel& superpixel,
                 const CurvedSurface& surface) const;

  // The same residual, each observation on the plane that is nearest to it:
  // where planes meet inside a superpixel, none of them explains it alone.
  float ResidualOfNearest(const Superpixel& superpixel,
                          const std::vector<CurvedSurface>& planes) const;

  // Of the observations and the votes of other views; see LabelOptions.
  float Cost(const Superpixel& superpixel, const CurvedSurface& surface) const;

  // Whether the superpixel lies in a region whose plane is another surface.
  bool OpposesRegion(int s, const CurvedSurface& surface) const;

  LabelEvidence EvidenceOf(const Superpixel& superpixel,
                           const CurvedSurface& surface) const;

 private:
  void MakeSuperpixels();
  void AddObservations(int s, Superpixel* superpixel) const;
  void SetPresentCost(int label, Superpixel* superpixel) const;
  SuperpixelVotes AskSources(const Superpixel& superpixel,
                             const CurvedSurface& surface) const;

  const ViewEvidence& evidence_;
  Intrinsics intrinsics_;
  DepthResolution resolution_;
  const LabeledView& labeled_;
  const CurvedSurfaceOptions& options_;
  std::vector<ObservedSource> sources_;
  std::vector<Superpixel> superpixels_;
};

}  // namespace tsar
