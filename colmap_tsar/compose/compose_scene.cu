// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_scene.h"

#include "colmap_tsar/compose/depth_confidence.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"

#include <utility>
#include <vector>

namespace tsar {
namespace {

// The provenance of a pixel that a plane of the scene fills.
TSAR_HD inline Provenance ProvenanceOfPlane(LabelOrigin origin) {
  switch (origin) {
    case LabelOrigin::kMeasured:
      return Provenance::kRegionPlane;
    case LabelOrigin::kCarried:
      return Provenance::kOtherViews;
    default:
      return Provenance::kGuessed;
  }
}

// The decision on the measured depth of a pixel.
enum OwnDepth : uint8_t {
  kGivesWay = 0,   // Replaced by a plane, or without support.
  kMoves = 1,      // Moved onto the plane that it measured.
  kContested = 2,  // Not on the plane, or there is no plane.
  kStands = 3,
};

// Classifies measurements by whether they lie on the plane of the scene.
struct OwnDepthKernel {
  ImageView<const float> depth;
  ImageView<const uint8_t> flags;
  PlaneRaster scene_planes;
  DepthResolution resolution;
  float on_plane;
  ImageView<uint8_t> own_depth;
  // The depths of contested measurements and of their planes; 0 elsewhere.
  ImageView<float> contested;
  ImageView<float> rivals;

  TSAR_HD void operator()(int x, int y) const {
    const float own = depth(x, y);
    const float plane = DepthOnPlane(scene_planes, x, y);
    const OwnDepth result = Judge(own, plane, flags(x, y));
    own_depth(x, y) = result;
    contested(x, y) = result == kContested ? own : 0.f;
    rivals(x, y) = result == kContested ? plane : 0.f;
  }

  TSAR_HD OwnDepth Judge(float own, float plane, uint8_t flags_of_own) const {
    if (!(own > 0.f) || (!MeasurementFlags::IsTrusted(flags_of_own) &&
                         !MeasurementFlags::IsConfirmed(flags_of_own))) {
      return kGivesWay;
    }
    return plane > 0.f && GapInPixels(own, plane, resolution) <= on_plane
               ? kMoves
               : kContested;
  }
};

// The support of the measurement at a pixel of the map.
TSAR_HD inline MeasurementSupport SupportAt(const ComposeSceneInputs& inputs,
                                            const OcclusionVotes& votes,
                                            int x,
                                            int y) {
  return {
      votes,
      ValueOnMap(inputs.texture, x, y, inputs.flags.width, inputs.flags.height),
      MeasurementFlags::IsTrusted(inputs.flags(x, y))};
}

// Decides contested measurements by the views, the image and the label.
struct ContestKernel {
  ComposeSceneInputs inputs;
  DepthResolution resolution;
  float min_log_odds;
  ImageView<const float> contested;
  ImageView<const float> rivals;
  ImageView<const OcclusionVotes> votes;
  ImageView<const OcclusionVotes> votes_on_rivals;
  ImageView<uint8_t> own_depth;

  TSAR_HD void operator()(int x, int y) const {
    if (own_depth(x, y) != kContested) {
      return;
    }
    const float rival = rivals(x, y);
    const PriorDepth prior = inputs.prior.At(x, y);
    if (!(rival > 0.f)) {
      own_depth(x, y) = StandsAgainstPrior(x, y, prior) ? kStands : kGivesWay;
      return;
    }
    const float gap = GapInPixels(contested(x, y), rival, resolution);
    const Rival plane{votes_on_rivals(x, y),
                      gap,
                      SuperpixelAt(inputs, x, y).label.margin,
                      MisfitOf(votes_on_rivals(x, y), votes(x, y))};
    const MeasurementSupport own = SupportAt(inputs, votes(x, y), x, y);
    const float log_odds = LogOddsAgainst(plane, own) +
                           LogLikelihoodRatio(prior, contested(x, y)) -
                           LogLikelihoodRatio(prior, rival);
    own_depth(x, y) = log_odds > min_log_odds ? kStands
                      : gap <= kOnSurface     ? kMoves
                                              : kGivesWay;
  }

  // Whether a measurement is kept where there is no plane.
  TSAR_HD bool StandsAgainstPrior(int x, int y, const PriorDepth& prior) const {
    const float log_ratio = LogLikelihoodRatio(prior, contested(x, y));
    if (log_ratio >= 0.f) {
      return true;
    }
    const float before =
        ConfidenceInSurface({DepthKind::kStanding,
                             SupportAt(inputs, votes(x, y), x, y),
                             {},
                             0.f,
                             0.f});
    return PosteriorProbability(before, log_ratio) >
           PosteriorProbability(0.5f, min_log_odds);
  }
};

struct ComposeSceneKernel {
  ComposeSceneInputs inputs;
  ImageView<const uint8_t> own_depth;
  ComposedViews map;  // At first the view's own hypotheses.

  TSAR_HD void operator()(int x, int y) const {
    const uint8_t own = own_depth(x, y);
    const Plane plane = inputs.scene_planes.At(x, y);
    if (own == kStands) {
      map.provenance(x, y) = static_cast<uint8_t>(Provenance::kMeasured);
    } else if (!plane.Valid()) {
      map.Set(x, y, 0.f, {}, Provenance::kNone);
    } else {
      map.Set(x,
              y,
              plane.Depth(inputs.scene_planes.intrinsics.Ray(x, y)),
              plane.normal,
              own == kMoves
                  ? Provenance::kMeasured
                  : ProvenanceOfPlane(SuperpixelAt(inputs, x, y).origin));
    }
  }
};

// The confidence of depths on cylinders between their outlines.
constexpr float kConfidenceOfCylinder = 0.9f;

struct SceneConfidenceKernel {
  ComposeSceneInputs inputs;
  ImageView<const float> depth;
  ImageView<const uint8_t> provenance;
  ImageView<const OcclusionVotes> votes;
  ImageView<const float> variances_on_cylinders;
  DepthResolution resolution;
  float noise;
  float min_fill_confidence;

  TSAR_HD float operator()(int x, int y) const {
    if (!(depth(x, y) > 0.f)) {
      return 0.f;
    }
    if (!variances_on_cylinders.Empty() && variances_on_cylinders(x, y) > 0.f) {
      return kConfidenceOfCylinder;
    }
    const DepthEvidence evidence = EvidenceAt(x, y);
    const bool is_measured =
        static_cast<Provenance>(provenance(x, y)) == Provenance::kMeasured;
    const float in_surface = ConfidenceInSurface(evidence);
    // The prior identifies the surface, but not the precise depth.
    const float with_prior = PosteriorProbability(
        in_surface, LogLikelihoodRatio(inputs.prior.At(x, y), depth(x, y)));
    return is_measured || with_prior >= min_fill_confidence
               ? inputs.prior.depth.Empty()
                     ? ConfidenceOf(evidence)
                     : BoundedConfidence(ConfidenceOf(evidence) * with_prior /
                                         in_surface)
               : 0.f;
  }

  TSAR_HD DepthEvidence EvidenceAt(int x, int y) const {
    return {KindAt(x, y),
            SupportAt(inputs, votes(x, y), x, y),
            SuperpixelAt(inputs, x, y).label,
            resolution.RelativeDepthError(depth(x, y)),
            noise};
  }

  TSAR_HD DepthKind KindAt(int x, int y) const {
    const auto source = static_cast<Provenance>(provenance(x, y));
    switch (source) {
      case Provenance::kInterpolated:
        return DepthKind::kInterpolated;
      case Provenance::kMeasured:
        return IsOnPlane(inputs.scene_planes, x, y, depth(x, y))
                   ? DepthKind::kMoved
                   : DepthKind::kStanding;
      case Provenance::kRegionPlane:
        return DepthKind::kFilled;
      case Provenance::kOtherViews:
        return DepthKind::kCarried;
      default:
        return DepthKind::kGuessed;
    }
  }
};

// Fills pixels without a depth by the prior, where it is probably on the right
// surface. Planes that are too doubtful to fill stay holes: where the prior
// contradicts one, it is as often wrong itself.
struct PriorFillKernel {
  ComposeSceneInputs inputs;
  float min_fill_confidence;
  ComposedViews map;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    const PriorDepth at_pixel = inputs.prior.At(x, y);
    if (map.depth(x, y) > 0.f || !(at_pixel.depth > 0.f) ||
        ProbabilityOfSurface(at_pixel) < min_fill_confidence) {
      return;
    }
    const Vec3f& mean = SuperpixelAt(inputs, x, y).prior_normal;
    const bool is_usable = AreOfOneSurface(mean) &&
                           Dot(mean, inputs.prior.intrinsics.Ray(x, y)) < 0.f;
    map.Set(x,
            y,
            at_pixel.depth,
            is_usable ? Normalized(mean) : inputs.prior.NormalAt(x, y),
            Provenance::kPrior);
    confidence(x, y) = BoundedConfidence(ProbabilityWithin(at_pixel, kRight));
  }

  // The relative error of a correct depth.
  static constexpr float kRight = 0.01f;
};

struct PlaneMapKernel {
  ImageView<const float> depth;
  PlaneRaster scene_planes;
  ImageView<const uint16_t> plane_ids;

  TSAR_HD uint16_t operator()(int x, int y) const {
    return IsOnPlane(scene_planes, x, y, depth(x, y))
               ? ValueOnMap(plane_ids, x, y, depth.width, depth.height)
               : 0;
  }
};

}  // namespace

ComposedMap ComposeScene(DepthNormalImages own,
                         const ComposeSceneInputs& inputs,
                         const ViewSurfaces& surfaces,
                         const DepthResolution& resolution,
                         const ComposeSceneOptions& options,
                         Device& device) {
  const int width = own.depth.Width();
  const int height = own.depth.Height();
  ComposedMap composed{std::move(own),
                       DeviceImage<uint8_t>(device, width, height)};
  DeviceImage<uint8_t> own_depth(device, width, height);
  {
    DeviceImage<float> contested(device, width, height);
    DeviceImage<float> rivals(device, width, height);
    ParallelFor(device,
                width,
                height,
                OwnDepthKernel{composed.map.depth.View(),
                               inputs.flags,
                               inputs.scene_planes,
                               resolution,
                               options.on_plane,
                               own_depth.View(),
                               contested.View(),
                               rivals.View()});
    const std::vector<DeviceImage<OcclusionVotes>> votes = CountOcclusionVotes(
        surfaces,
        inputs.scene_planes.intrinsics,
        {std::as_const(contested).View(), std::as_const(rivals).View()},
        device);
    ParallelFor(device,
                width,
                height,
                ContestKernel{inputs,
                              resolution,
                              options.min_log_odds,
                              std::as_const(contested).View(),
                              std::as_const(rivals).View(),
                              votes[0].View(),
                              votes[1].View(),
                              own_depth.View()});
  }
  ParallelFor(device,
              width,
              height,
              ComposeSceneKernel{
                  inputs, std::as_const(own_depth).View(), composed.Views()});
  return composed;
}

DeviceImage<float> ComputeSceneConfidence(
    const ComposedMap& composed,
    const ComposeSceneInputs& inputs,
    const ViewSurfaces& surfaces,
    const DepthResolution& resolution,
    ImageView<const float> variances_on_cylinders,
    float noise,
    float min_fill_confidence,
    Device& device) {
  const std::vector<DeviceImage<OcclusionVotes>> votes =
      CountOcclusionVotes(surfaces,
                          inputs.scene_planes.intrinsics,
                          {composed.map.depth.View()},
                          device);
  return MapPixels<float>(device,
                          inputs.flags.width,
                          inputs.flags.height,
                          SceneConfidenceKernel{inputs,
                                                composed.map.depth.View(),
                                                composed.provenance.View(),
                                                votes[0].View(),
                                                variances_on_cylinders,
                                                resolution,
                                                noise,
                                                min_fill_confidence});
}

void FillByPrior(const ComposeSceneInputs& inputs,
                 float min_fill_confidence,
                 ComposedMap* composed,
                 DeviceImage<float>* confidence,
                 Device& device) {
  if (inputs.prior.depth.Empty()) {
    return;
  }
  ParallelFor(
      device,
      confidence->Width(),
      confidence->Height(),
      PriorFillKernel{
          inputs, min_fill_confidence, composed->Views(), confidence->View()});
}

DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> plane_ids,
                                Device& device) {
  return MapPixels<uint16_t>(device,
                             depth.width,
                             depth.height,
                             PlaneMapKernel{depth, scene_planes, plane_ids});
}

}  // namespace tsar
