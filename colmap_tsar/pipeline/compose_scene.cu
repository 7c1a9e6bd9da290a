// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/compose_scene.h"

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"
#include <cstdlib>

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// The depth of a plane of a raster; 0 where it has none.
TSAR_HD inline float DepthOnPlane(const PlaneRaster& raster, int x, int y) {
  const Plane plane = raster.At(x, y);
  return plane.Valid() ? plane.Depth(raster.intrinsics.Ray(x, y)) : 0.f;
}

// How the plane of the scene under a pixel of the map came there.
TSAR_HD inline LabelEvidence EvidenceAt(const ComposeSceneInputs& inputs,
                                        int x,
                                        int y) {
  const ImageView<const uint8_t>& evidence = inputs.label_evidence;
  return static_cast<LabelEvidence>(evidence(
      ReducedRaster::FromMap(x, inputs.trust.width, evidence.width),
      ReducedRaster::FromMap(y, inputs.trust.height, evidence.height)));
}

// Marks measurements that do not lie on a plane of the scene.
struct OffPlaneKernel {
  ImageView<const float> depth;
  ImageView<const uint8_t> trust;
  PlaneRaster scene_planes;
  DepthResolution resolution;
  ComposeSceneOptions options;
  ImageView<uint8_t> off_plane;
  int min_confirmations;
  float gap;
  float rgap;

  TSAR_HD void operator()(int x, int y) const {
    const float own = depth(x, y);
    const bool is_trusted = MeasurementRating::IsTrusted(trust(x, y));
    const bool is_confirmed = MeasurementRating::Confirmations(trust(x, y)) >= min_confirmations;
    bool is_off = is_trusted && own > 0.f;
    const float plane = is_off || is_confirmed ? DepthOnPlane(scene_planes, x, y) : 0.f;
    if (is_off && plane > 0.f) {
      is_off = options.keep_off_plane &&
               fabsf(plane - own) > options.on_plane.At(own, resolution) * own;
    }
    off_plane(x, y) = is_off ? 1 : 0;
    if (is_confirmed && own > 0.f && !(plane > 0.f && fabsf(plane - own) <= gap * resolution.RelativeDepthError(own) * own) && !(plane > 0.f && fabsf(plane - own) <= rgap * own)) off_plane(x, y) = 2;
  }
};

struct OffPlane {
  const uint8_t* off_plane;
  TSAR_HD bool Contains(int i) const { return off_plane[i] != 0; }
  TSAR_HD bool Connected(int, int) const { return true; }
};

struct ComposeSceneKernel {
  ComposeSceneInputs inputs;
  ImageView<const int> blobs;
  const int* blob_sizes;
  ImageView<const uint8_t> off_plane;
  int min_blob;
  // The own hypotheses, which the result replaces.
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;

  TSAR_HD void operator()(int x, int y) const {
    const int blob = blobs(x, y);
    if (blob >= 0 && (off_plane(x, y) == 2 || blob_sizes[blob] >= min_blob)) {
      provenance(x, y) = static_cast<uint8_t>(Provenance::kMeasured);
      return;
    }
    const bool is_trusted = MeasurementRating::IsTrusted(inputs.trust(x, y)) && depth(x, y) > 0.f;
    Provenance source = Provenance::kNone;
    Plane plane = inputs.scene_planes.At(x, y);
    Vec3f ray = inputs.scene_planes.intrinsics.Ray(x, y);
    if (plane.Valid()) {
      source = is_trusted && blob < 0 ? Provenance::kMeasured
               : EvidenceAt(inputs, x, y) == LabelEvidence::kMeasured
                   ? Provenance::kRegionPlane
                   : Provenance::kOtherViews;
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

// What a plane of the scene is worth where no view measured it.
constexpr float kGuessConfidence = 0.3f;

struct SceneConfidenceKernel {
  ComposeSceneInputs inputs;
  ImageView<const uint8_t> provenance;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    const auto source = static_cast<Provenance>(provenance(x, y));
    float value = ConfidenceOfFilled(source);
    if (source == Provenance::kMeasured) {
      value = fmaxf(MeasurementRating::Score(inputs.trust(x, y)), .2f);
    } else if (source == Provenance::kOtherViews &&
               EvidenceAt(inputs, x, y) != LabelEvidence::kCarried) {
      value = kGuessConfidence;
    }
    confidence(x, y) = value;
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
  DeviceImage<uint8_t> off_plane(device, width, height);
  ParallelFor(device,
              width,
              height,
              OffPlaneKernel{composed.map.depth.View(),
                             inputs.trust,
                             inputs.scene_planes,
                             resolution,
                             options,
                             off_plane.View(), getenv("TP_CONF") ? atoi(getenv("TP_CONF")) : 9, getenv("TP_GAP") ? (float)atof(getenv("TP_GAP")) : 1.2f, getenv("TP_RGAP") ? (float)atof(getenv("TP_RGAP")) : 0.f});
  DeviceImage<int> blobs(device, width, height);
  LabelComponents(device,
                  OffPlane{off_plane.View().data},
                  Connectivity::kFour,
                  blobs.View());
  const size_t num_pixels = blobs.View().NumPixels();
  Buffer<int> blob_sizes(device, num_pixels);
  Fill(device, blob_sizes.Data(), num_pixels, 0);
  CountComponentPixels(device, blobs.View(), blob_sizes.Data());
  const double pixels_per_raster_pixel =
      static_cast<double>(num_pixels) /
      static_cast<double>(inputs.label_evidence.NumPixels());
  ParallelFor(device,
              width,
              height,
              ComposeSceneKernel{
                  inputs,
                  blobs.View(),
                  blob_sizes.Data(),
                  off_plane.View(),
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
      device, inputs.trust.width, inputs.trust.height);
  ParallelFor(device,
              confidence.Width(),
              confidence.Height(),
              SceneConfidenceKernel{
                  inputs, composed.provenance.View(), confidence.View()});
  return confidence;
}

int64_t ComposeSceneWorkingBytes(int64_t num_pixels) {
  const int64_t provenance_and_off_plane = 2 * BytesOf<uint8_t>(num_pixels);
  const int64_t blobs_and_sizes = 2 * BytesOf<int>(num_pixels);
  return provenance_and_off_plane + blobs_and_sizes;
}

}  // namespace tsar
