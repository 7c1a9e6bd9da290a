// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/compose_scene.h"

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// Of a plane of the scene that fills a pixel.
TSAR_HD inline Provenance ProvenanceOfPlane(LabelEvidence evidence) {
  switch (evidence) {
    case LabelEvidence::kMeasured:
      return Provenance::kRegionPlane;
    case LabelEvidence::kCarried:
      return Provenance::kOtherViews;
    default:
      return Provenance::kGuessed;
  }
}

// What becomes of the depth that a pixel measured.
enum OwnDepth : uint8_t {
  kGivesWay = 0,       // To a plane, or because nothing speaks for it.
  kMoves = 1,          // Onto the plane that it measured.
  kStandsInABlob = 2,  // Trusted: if enough of its neighbours do, too.
  kStands = 3,         // Other views confirm it.
};

// Finds the measurements that do not lie on a plane of the scene.
struct OwnDepthKernel {
  ImageView<const float> depth;
  ImageView<const uint8_t> rating;
  PlaneRaster scene_planes;
  DepthResolution resolution;
  ComposeSceneOptions options;
  ImageView<uint8_t> own_depth;

  TSAR_HD void operator()(int x, int y) const {
    own_depth(x, y) = Judge(depth(x, y), rating(x, y), x, y);
  }

  TSAR_HD uint8_t Judge(float own, uint8_t rating_of_own, int x, int y) const {
    const bool is_trusted = MeasurementRating::IsTrusted(rating_of_own);
    const bool is_confirmed =
        options.keep_confirmed && MeasurementRating::IsConfirmed(rating_of_own);
    if (!(own > 0.f) || (!is_trusted && !is_confirmed)) {
      return kGivesWay;
    }
    const PlaneTolerance& on_plane =
        !is_confirmed ? options.on_plane
        : MeasurementRating::IsConfirmedDistinctly(rating_of_own)
            ? options.on_plane_distinct
            : options.on_plane_weak;
    const float plane = DepthOnPlane(scene_planes, x, y);
    if (plane > 0.f &&
        (!options.keep_off_plane ||
         fabsf(plane - own) <= on_plane.At(own, resolution) * own)) {
      return kMoves;
    }
    return is_confirmed ? kStands : kStandsInABlob;
  }
};

struct Standing {
  const uint8_t* own_depth;
  TSAR_HD bool Contains(int i) const { return own_depth[i] >= kStandsInABlob; }
  TSAR_HD bool Connected(int, int) const { return true; }
};

struct ComposeSceneKernel {
  ComposeSceneInputs inputs;
  ImageView<const uint8_t> own_depth;
  ImageView<const int> blobs;
  const int* blob_sizes;
  int min_blob;
  // The own hypotheses, which the result replaces.
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;

  TSAR_HD void operator()(int x, int y) const {
    const uint8_t own = own_depth(x, y);
    if (own == kStands ||
        (own == kStandsInABlob && blob_sizes[blobs(x, y)] >= min_blob)) {
      provenance(x, y) = static_cast<uint8_t>(Provenance::kMeasured);
      return;
    }
    Provenance source = Provenance::kNone;
    Plane plane = inputs.scene_planes.At(x, y);
    Vec3f ray = inputs.scene_planes.intrinsics.Ray(x, y);
    if (plane.Valid()) {
      source = own == kMoves
                   ? Provenance::kMeasured
                   : ProvenanceOfPlane(SuperpixelAt(inputs, x, y).evidence);
    } else {
      plane = inputs.region_planes.At(x, y);
      ray = inputs.region_planes.intrinsics.Ray(x, y);
      source = plane.Valid() ? Provenance::kRegionPlane : Provenance::kNone;
    }
    depth(x, y) = plane.Valid() ? plane.Depth(ray) : 0.f;
    normal(x, y) = plane.Valid() ? plane.normal : Vec3f{};
    provenance(x, y) = static_cast<uint8_t>(source);
  }
};

struct SceneConfidenceKernel {
  ComposeSceneInputs inputs;
  ImageView<const float> depth;
  ImageView<const uint8_t> provenance;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    confidence(x, y) = Rate(static_cast<Provenance>(provenance(x, y)),
                            IsOnPlane(inputs.scene_planes, x, y, depth(x, y)),
                            inputs.ratings(x, y),
                            SuperpixelAt(inputs, x, y).confidence);
  }

  TSAR_HD static float Rate(Provenance source,
                            bool is_on_plane,
                            uint8_t rating,
                            const SurfaceConfidence& surface) {
    switch (source) {
      case Provenance::kNone:
        return 0.f;
      case Provenance::kInterpolated:
        return kConfidenceOfInterpolated;
      case Provenance::kMeasured:
        return is_on_plane                         ? surface.moved
               : MeasurementRating::IsSure(rating) ? surface.standing
                                                   : surface.standing_weakly;
      default:
        return is_on_plane ? surface.filled : kConfidenceOfRegion;
    }
  }
};

struct PlaneMapKernel {
  ImageView<const float> depth;
  PlaneRaster scene_planes;
  ImageView<const uint16_t> numbers;
  ImageView<uint16_t> map;

  TSAR_HD void operator()(int x, int y) const {
    map(x, y) =
        IsOnPlane(scene_planes, x, y, depth(x, y))
            ? numbers(ReducedRaster::FromMap(x, depth.width, numbers.width),
                      ReducedRaster::FromMap(y, depth.height, numbers.height))
            : 0;
  }
};

}  // namespace

ComposedMap ComposeScene(DepthNormalImages own,
                         const ComposeSceneInputs& inputs,
                         const DepthResolution& resolution,
                         const ComposeSceneOptions& options,
                         Device& device) {
  const int width = own.depth.Width();
  const int height = own.depth.Height();
  ComposedMap composed{std::move(own),
                       DeviceImage<uint8_t>(device, width, height)};
  DeviceImage<uint8_t> own_depth(device, width, height);
  ParallelFor(device,
              width,
              height,
              OwnDepthKernel{composed.map.depth.View(),
                             inputs.ratings,
                             inputs.scene_planes,
                             resolution,
                             options,
                             own_depth.View()});
  DeviceImage<int> blobs(device, width, height);
  LabelComponents(device,
                  Standing{own_depth.View().data},
                  Connectivity::kFour,
                  blobs.View());
  const size_t num_pixels = blobs.View().NumPixels();
  Buffer<int> blob_sizes(device, num_pixels);
  Fill(device, blob_sizes.Data(), num_pixels, 0);
  CountComponentPixels(device, blobs.View(), blob_sizes.Data());
  const double pixels_per_raster_pixel =
      static_cast<double>(num_pixels) /
      static_cast<double>(inputs.superpixels.NumPixels());
  ParallelFor(device,
              width,
              height,
              ComposeSceneKernel{
                  inputs,
                  own_depth.View(),
                  blobs.View(),
                  blob_sizes.Data(),
                  static_cast<int>(options.min_blob * pixels_per_raster_pixel),
                  composed.map.depth.View(),
                  composed.map.normal.View(),
                  composed.provenance.View()});
  return composed;
}

DeviceImage<float> RateSceneConfidence(const ComposedMap& composed,
                                       const ComposeSceneInputs& inputs,
                                       Device& device) {
  DeviceImage<float> confidence(
      device, inputs.ratings.width, inputs.ratings.height);
  ParallelFor(device,
              confidence.Width(),
              confidence.Height(),
              SceneConfidenceKernel{inputs,
                                    composed.map.depth.View(),
                                    composed.provenance.View(),
                                    confidence.View()});
  return confidence;
}

DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> numbers,
                                Device& device) {
  DeviceImage<uint16_t> map(device, depth.width, depth.height);
  ParallelFor(device,
              depth.width,
              depth.height,
              PlaneMapKernel{depth, scene_planes, numbers, map.View()});
  return map;
}

}  // namespace tsar
