// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/plane_costs.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/priors/prior_likelihood.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/labeling/color_costs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// Depths are possible down to this share of the nearest observation, and up to
// its inverse times the farthest.
constexpr float kDepthMargin = 0.5f;
// The share of the nearest, and of the farthest observations that are left out
// as outliers.
constexpr double kDepthQuantile = 0.005;
// The cost of a pixel on a plane without a possible depth there.
constexpr float kCostOfImpossible = 2.f;
// More views than this that confirm a pixel change nothing.
constexpr int kMaxVotes = 2;
// Of the eight sectors of directions around a point, a plane is known from this
// number with observations on, and fully unknown up to that one.
constexpr int kSectorsKnown = 7;
constexpr int kSectorsUnknown = 3;
// Lower bound of the slope of a ray to a plane, which bounds the error of the
// depth.
constexpr float kMinSlope = 0.02f;

// The evidence of one superpixel.
struct SuperpixelData {
  int first_observation = 0;
  int num_observations = 0;
  int first_confirmed = 0;
  int num_confirmed = 0;     // In the sample,
  int confirmed_pixels = 0;  // and in total.
  int num_pixels = 0;
  float weight = 0.f;
  float confidence = 0.f;  // Sum over the observations.
  Vec3f ray;               // Of the center of the pixels.
  Vec3f prior_normal;      // See AlignedPrior; (0, 0, 0): none.
};

struct PlaneData {
  Plane plane;
  PlaneFrame frame;
  int first_cell = 0;
  int num_cells = 0;
  float cell_size = 0.f;
};

// The weights of inliers and outliers of a plane.
struct Measurements {
  float on = 0.f;
  float off = 0.f;

  TSAR_HD void Add(float residual_share, float weight) {
    (residual_share < 1.f ? on : off) += weight;
  }
};

struct CostKernel {
  const SuperpixelData* superpixels;
  const PlaneData* planes;
  const Observation* observations;
  const ObservationSource* observation_sources;
  const float* errors;  // Null: all 1.
  const RayDepth* confirmed;
  PixelGroupsView pixels;  // By superpixel.
  const PlanePoint* cells;
  const ObservedSource* sources;
  int num_sources;
  VoteSampling sampling;
  float max_confirmed_gap;
  int raster_width;
  Intrinsics intrinsics;
  DepthResolution resolution;
  float min_depth;
  float max_depth;
  LabelOptions options;
  float normal_sigma;
  float normal_cost;
  ImageView<PlaneCost> costs;  // Column: plane, row: superpixel.

  TSAR_HD void operator()(int k, int s) const {
    const SuperpixelData& superpixel = superpixels[s];
    const PlaneData& plane = planes[k];
    PlaneCost result;
    AddObservations(superpixel, plane.plane, &result);
    AddOtherViews(s, plane.plane, &result);
    const float unobserved =
        fmaxf(superpixel.num_pixels - superpixel.weight, 0.f);
    result.cost += unobserved * CostOfNormal(superpixel, plane.plane);
    result.uncertainty = Uncertainty(superpixel.ray, plane);
    result.cost += options.uncertainty_cost * unobserved * result.uncertainty;
    costs(k, s) = result;
  }

  TSAR_HD bool IsPossible(float depth) const {
    return depth > 0.f && depth >= min_depth && depth <= max_depth;
  }

  TSAR_HD void AddObservations(const SuperpixelData& superpixel,
                               const Plane& plane,
                               PlaneCost* result) const {
    float cost = 0.f;
    float explained = 0.f;
    Measurements measured;
    for (int i = 0; i < superpixel.num_observations; ++i) {
      const int index = superpixel.first_observation + i;
      const Observation& observation = observations[index];
      const ObservationSource source = observation_sources[index];
      const float share = ResidualShare(
          observation.sample,
          plane,
          errors == nullptr ? 1.f : errors[index],
          source == ObservationSource::kPrior ? kSlackOfPrior : 0.f);
      cost += observation.confidence * share * share;
      explained += share < 1.f && source != ObservationSource::kPrior
                       ? observation.confidence
                       : 0.f;
      if (source == ObservationSource::kMeasured) {
        measured.Add(share, observation.confidence);
      }
    }
    if (superpixel.confidence > 0.f) {
      const float scale = superpixel.weight / superpixel.confidence;
      result->cost += cost * scale;
      result->explained = explained / superpixel.confidence;
      measured.on *= scale;
      measured.off *= scale;
    }
    AddConfirmed(superpixel, plane, &measured, result);
    result->strength =
        measured.on / (measured.on + measured.off +
                       options.strength_prior * superpixel.num_pixels);
  }

  // Adds depths that other views confirm and that this view did not trust.
  TSAR_HD void AddConfirmed(const SuperpixelData& superpixel,
                            const Plane& plane,
                            Measurements* measured,
                            PlaneCost* result) const {
    const float weight = options.confirmed_weight *
                         superpixel.confirmed_pixels / superpixel.num_confirmed;
    for (int i = 0; i < superpixel.num_confirmed; ++i) {
      const float share = ResidualShare(
          confirmed[superpixel.first_confirmed + i], plane, 1.f, 0.f);
      result->cost += weight * share * share;
      measured->Add(share, weight);
    }
  }

  // The residual of a depth beyond the slack, as a share of the tolerance
  // scaled by the expected error, at most 1.
  TSAR_HD float ResidualShare(const RayDepth& sample,
                              const Plane& plane,
                              float error,
                              float slack) const {
    const float depth = plane.Depth({sample.x, sample.y, 1.f});
    if (!(depth > 0.f)) {
      return 1.f;
    }
    const float residual = fabsf(depth - sample.z) /
                           (sample.z * resolution.RelativeDepthError(sample.z));
    return fminf(fmaxf(residual / (options.tolerance * error) - slack, 0.f),
                 1.f);
  }

  // The cost of a pixel by the prior's normal.
  TSAR_HD float CostOfNormal(const SuperpixelData& superpixel,
                             const Plane& plane) const {
    const Vec3f& mean = superpixel.prior_normal;
    if (!(Norm(mean) > 0.f)) {
      return 0.f;
    }
    const float deviation =
        Norm(Normalized(mean) - plane.normal) / NormalSigma(normal_sigma, mean);
    const float share = fminf(fmaxf(0.5f * deviation - 1.f, 0.f), 1.f);
    return normal_cost * share * share;
  }

  TSAR_HD void AddOtherViews(int superpixel,
                             const Plane& plane,
                             PlaneCost* result) const {
    const int num_pixels = pixels.Count(superpixel);
    if (num_pixels == 0) {
      return;
    }
    const int num_tests = sampling.NumTests(num_pixels);
    int num_confirmed = 0;
    int num_impossible = 0;
    for (int i = 0; i < num_tests; ++i) {
      const int pixel = pixels.Pixel(
          superpixel, VoteSampling::Pixel(i, num_tests, num_pixels));
      const Vec3f ray =
          intrinsics.Ray(pixel % raster_width, pixel / raster_width);
      const float depth = plane.Depth(ray);
      if (!IsPossible(depth)) {
        ++num_impossible;
        continue;
      }
      int num_votes = 0;
      for (int j = 0; j < num_sources && num_votes < kMaxVotes; ++j) {
        num_votes +=
            Confirms(sources[j], ray * depth, max_confirmed_gap) ? 1 : 0;
      }
      num_confirmed += num_votes;
    }
    const float pixels_per_test = static_cast<float>(num_pixels) / num_tests;
    result->cost += kCostOfImpossible * pixels_per_test * num_impossible;
    result->confirmed =
        static_cast<float>(num_confirmed) / (num_tests * kMaxVotes);
  }

  // The uncertainty of the plane's depth there, from 0 to 1.
  TSAR_HD float Uncertainty(const Vec3f& ray, const PlaneData& plane) const {
    const float depth = plane.plane.Depth(ray);
    if (!IsPossible(depth)) {
      return 1.f;
    }
    const PlanePoint point = plane.frame.Coordinates(ray * depth);
    const float slope = fmaxf(-Dot(plane.plane.normal, ray), kMinSlope);
    const float sigma = plane.frame.Sigma(point) / slope /
                        (depth * resolution.RelativeDepthError(depth));
    const float share = fminf(sigma / options.max_sigma, 1.f);
    return fmaxf(
        share * share,
        options.extrapolation_uncertainty * Extrapolation(point, plane));
  }

  // The degree of extrapolation: 0 where the plane was observed all around the
  // point or next to it, 1 where the point lies far out on one side.
  TSAR_HD float Extrapolation(const PlanePoint& point,
                              const PlaneData& plane) const {
    if (plane.num_cells == 0) {
      return 1.f;
    }
    unsigned sectors = 0;  // With observations, one bit each.
    float nearest = INFINITY;
    for (int i = 0; i < plane.num_cells; ++i) {
      const PlanePoint& cell = cells[plane.first_cell + i];
      const float s = cell.s - point.s;
      const float t = cell.t - point.t;
      sectors |= 1u << ((s > 0.f ? 1u : 0u) | (t > 0.f ? 2u : 0u) |
                        (fabsf(s) > fabsf(t) ? 4u : 0u));
      nearest = fminf(nearest, s * s + t * t);
    }
    int num_sectors = 0;
    for (; sectors != 0; sectors &= sectors - 1) {
      ++num_sectors;
    }
    const float openness = static_cast<float>(kSectorsKnown - num_sectors) /
                           (kSectorsKnown - kSectorsUnknown);
    const float reach = options.extrapolation_reach * plane.cell_size *
                        sqrtf(static_cast<float>(plane.num_cells));
    return fminf(fmaxf(openness, 0.f), 1.f) *
           fminf(sqrtf(nearest) / reach, 1.f);
  }
};

std::vector<PlaneData> MakePlaneData(const std::vector<Plane>& planes,
                                     const PlaneSupport& support) {
  std::vector<PlaneData> result;
  for (size_t k = 0; k < planes.size(); ++k) {
    const int first = support.first_cell[k];
    result.push_back({planes[k],
                      support.frames[k],
                      first,
                      support.first_cell[k + 1] - first,
                      support.cell_sizes[k]});
  }
  return result;
}

std::vector<SuperpixelData> MakeSuperpixelData(const ViewEvidence& evidence,
                                               const Intrinsics& intrinsics) {
  const std::vector<float> num_pixels = CountPixels(evidence);
  const std::vector<Vec3f> rays = MiddleRays(evidence, intrinsics);
  std::vector<SuperpixelData> superpixels;
  for (size_t s = 0; s < evidence.weights.size(); ++s) {
    SuperpixelData data;
    data.first_observation = evidence.first_observation[s];
    data.num_observations =
        evidence.first_observation[s + 1] - data.first_observation;
    if (!evidence.first_confirmed.empty()) {
      data.first_confirmed = evidence.first_confirmed[s];
      data.num_confirmed =
          evidence.first_confirmed[s + 1] - data.first_confirmed;
      data.confirmed_pixels = evidence.confirmed_pixels[s];
    }
    data.num_pixels = static_cast<int>(num_pixels[s]);
    data.weight = evidence.weights[s];
    for (int i = 0; i < data.num_observations; ++i) {
      data.confidence +=
          evidence.observations[data.first_observation + i].confidence;
    }
    data.ray = rays[s];
    if (!evidence.prior.normals.empty()) {
      data.prior_normal = evidence.prior.normals[s];
    }
    superpixels.push_back(data);
  }
  return superpixels;
}

// The nearest and the farthest depth that a plane may have.
std::pair<float, float> DepthRange(const ViewEvidence& evidence) {
  std::vector<float> depths;
  for (const Observation& observation : evidence.observations) {
    depths.push_back(observation.sample.z);
  }
  if (depths.empty()) {
    return {0.f, 0.f};
  }
  std::sort(depths.begin(), depths.end());
  const auto last = static_cast<double>(depths.size() - 1);
  const auto at = [&](double quantile) { return depths[last * quantile]; };
  return {at(kDepthQuantile) * kDepthMargin,
          at(1.0 - kDepthQuantile) / kDepthMargin};
}

}  // namespace

Image<PlaneCost> ComputePlaneCosts(const LabelInputs& inputs,
                                   const std::vector<Plane>& planes,
                                   const PlaneSupport& support,
                                   const LabelOptions& options,
                                   Device& device) {
  const ObservedView& reference = inputs.Views()[0];
  const ViewEvidence& evidence = *reference.evidence;
  const Intrinsics intrinsics = reference.camera.GetIntrinsics();
  const Buffer<SuperpixelData> superpixels(
      device, MakeSuperpixelData(evidence, intrinsics));
  const Buffer<PlaneData> device_planes(device, MakePlaneData(planes, support));
  const Buffer<Observation> observations(device, evidence.observations);
  const Buffer<ObservationSource> observation_sources(device, evidence.sources);
  const Buffer<float> errors(device, evidence.errors);
  const Buffer<RayDepth> confirmed(device, evidence.confirmed);
  const Buffer<PlanePoint> cells(device, support.cells);
  const auto [min_depth, max_depth] = DepthRange(evidence);
  DeviceImage<PlaneCost> costs(
      device, static_cast<int>(planes.size()), evidence.NumSuperpixels());
  ParallelFor(device,
              costs.Width(),
              costs.Height(),
              CostKernel{superpixels.Data(),
                         device_planes.Data(),
                         observations.Data(),
                         observation_sources.Data(),
                         evidence.errors.empty() ? nullptr : errors.Data(),
                         confirmed.Data(),
                         inputs.Pixels(),
                         cells.Data(),
                         inputs.Sources(),
                         inputs.NumSources(),
                         kPlaneSampling,
                         options.confirmation_share * options.tolerance,
                         evidence.width,
                         intrinsics,
                         evidence.resolution,
                         min_depth,
                         max_depth,
                         options,
                         evidence.prior.assessment.normal_sigma,
                         options.normal_cost *
                             (1.f - evidence.prior.normal_outlier_share),
                         costs.View()});
  AddColorCosts(inputs, planes, options, costs.View(), device);
  return costs.ToHost();
}

}  // namespace tsar
