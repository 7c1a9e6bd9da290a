// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/label_view.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/pixel_groups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// One of so many pixels of a superpixel is tested against the other views.
constexpr int kPixelsPerTest = 9;
// More views than these that say the same about a pixel change nothing.
constexpr int kMaxVotes = 2;
// Depths are believed down to this share of the nearest observation, and up to
// its inverse times the farthest.
constexpr float kDepthMargin = 0.5f;
// The shares of the observations that are left out as the nearest and the
// farthest: some are wrong.
constexpr double kDepthQuantile = 0.005;
// What a pixel costs that cannot lie on a plane.
constexpr float kCostOfImpossible = 2.f;
// Directions of eight in which a plane must have been observed around a point
// to be known there, and in which so few that it is not.
constexpr int kSectorsKnown = 7;
constexpr int kSectorsUnknown = 3;
// The flattest slope of a ray to a plane that counts: beyond, the error of the
// depth would have no bound.
constexpr float kMinSlope = 0.02f;

// A view that looks at the same scene, on its raster.
struct Witness {
  Intrinsics intrinsics;
  RelativePose from_reference;
  DisparityScale scale;
  ImageView<const float> strong_depth;
};

// A superpixel's part of the evidence.
struct SuperpixelData {
  int first_observation = 0;
  int num_observations = 0;
  int first_pixel = 0;
  int num_pixels = 0;
  float mass = 0.f;
  // Quality of the observations together.
  float quality = 0.f;
  // The middle of the pixels.
  Vec3f ray;
};

struct PlaneData {
  Plane plane;
  PlaneFrame frame;
  int first_cell = 0;
  int num_cells = 0;
  float cell_size = 0.f;
};

// What the costs of one superpixel on one plane were made of.
struct PlaneCost {
  float cost = 0.f;
  // Observations on the plane, as a share of all.
  float explained = 0.f;
  // Pixels that other views confirm, as a share of those tested.
  float confirmed = 0.f;
};

struct CostKernel {
  const SuperpixelData* superpixels;
  const PlaneData* planes;
  const Observation* observations;
  const int* pixels;
  const PlanePoint* cells;
  const Witness* witnesses;
  int num_witnesses;
  int raster_width;
  Intrinsics intrinsics;
  DisparityScale scale;
  float min_depth;
  float max_depth;
  LabelOptions options;
  ImageView<PlaneCost> costs;  // Column: plane, row: superpixel.

  TSAR_HD void operator()(int k, int s) const {
    const SuperpixelData& superpixel = superpixels[s];
    const PlaneData& plane = planes[k];
    PlaneCost result;
    AddObservations(superpixel, plane.plane, &result);
    AddOtherViews(superpixel, plane.plane, &result);
    const float unobserved =
        fmaxf(superpixel.num_pixels - superpixel.mass, 0.f);
    result.cost +=
        options.cost_of_doubt * unobserved * Doubt(superpixel.ray, plane);
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
    for (int i = 0; i < superpixel.num_observations; ++i) {
      const Observation& observation =
          observations[superpixel.first_observation + i];
      const RayDepth& sample = observation.sample;
      const float depth = plane.Depth({sample.x, sample.y, 1.f});
      float share = 1.f;
      if (depth > 0.f) {
        const float residual = fabsf(depth - sample.z) /
                               (sample.z * scale.RelativeDepthError(sample.z));
        share = fminf(residual / options.tolerance, 1.f);
      }
      cost += observation.quality * share * share;
      explained += share < 1.f ? observation.quality : 0.f;
    }
    if (superpixel.quality > 0.f) {
      result->cost += cost * superpixel.mass / superpixel.quality;
      result->explained = explained / superpixel.quality;
    }
  }

  TSAR_HD void AddOtherViews(const SuperpixelData& superpixel,
                             const Plane& plane,
                             PlaneCost* result) const {
    if (superpixel.num_pixels == 0) {
      return;
    }
    const int num_tests = superpixel.num_pixels < kPixelsPerTest
                              ? 1
                              : superpixel.num_pixels / kPixelsPerTest;
    int num_impossible = 0;
    int num_confirmed = 0;
    int num_contradicted = 0;
    for (int i = 0; i < num_tests; ++i) {
      const int pixel =
          pixels[superpixel.first_pixel +
                 (2 * i + 1) * superpixel.num_pixels / (2 * num_tests)];
      const Vec3f ray =
          intrinsics.Ray(pixel % raster_width, pixel / raster_width);
      const float depth = plane.Depth(ray);
      if (!IsPossible(depth)) {
        ++num_impossible;
        continue;
      }
      int confirmed = 0;
      int contradicted = 0;
      AskWitnesses(ray * depth, &confirmed, &contradicted);
      num_confirmed += confirmed < kMaxVotes ? confirmed : kMaxVotes;
      num_contradicted += contradicted < kMaxVotes ? contradicted : kMaxVotes;
    }
    const float pixels_per_test =
        static_cast<float>(superpixel.num_pixels) / num_tests;
    const float pixels_per_vote = pixels_per_test / kMaxVotes;
    result->cost +=
        kCostOfImpossible * pixels_per_test * num_impossible +
        options.cost_of_contradiction * pixels_per_vote * num_contradicted -
        options.gain_of_confirmation * pixels_per_vote * num_confirmed;
    result->confirmed =
        static_cast<float>(num_confirmed) / (num_tests * kMaxVotes);
  }

  TSAR_HD void AskWitnesses(const Vec3f& point,
                            int* confirmed,
                            int* contradicted) const {
    for (int j = 0; j < num_witnesses; ++j) {
      const Witness& witness = witnesses[j];
      const Vec3f seen = witness.from_reference * point;
      if (!(seen.z > 0.f)) {
        continue;
      }
      float x = 0.f;
      float y = 0.f;
      witness.intrinsics.Project(seen, &x, &y);
      // As floats, since far outside they do not fit into integers.
      if (!(x >= 0.f && y >= 0.f && x < witness.strong_depth.width - 0.5f &&
            y < witness.strong_depth.height - 0.5f)) {
        continue;
      }
      const float measured = witness.strong_depth(static_cast<int>(x + 0.5f),
                                                  static_cast<int>(y + 0.5f));
      if (!(measured > 0.f)) {
        continue;
      }
      const float gap = (seen.z - measured) /
                        (measured * witness.scale.RelativeDepthError(measured));
      if (fabsf(gap) < options.confirmation_share * options.tolerance) {
        ++*confirmed;
      } else if (gap < -options.min_contradiction) {
        ++*contradicted;
      }
    }
  }

  // How little is known about the plane's depth there, from 0 to 1.
  TSAR_HD float Doubt(const Vec3f& ray, const PlaneData& plane) const {
    const float depth = plane.plane.Depth(ray);
    if (!IsPossible(depth)) {
      return 1.f;
    }
    const PlanePoint point = plane.frame.Coordinates(ray * depth);
    const float slope = fmaxf(-Dot(plane.plane.normal, ray), kMinSlope);
    const float sigma = plane.frame.Sigma(point) / slope /
                        (depth * scale.RelativeDepthError(depth));
    const float share = fminf(sigma / options.max_sigma, 1.f);
    return fmaxf(share * share,
                 options.doubt_of_extrapolation * Extrapolation(point, plane));
  }

  // 0 where the plane was observed all around the point or next to it, 1 where
  // the point lies far out on one side.
  TSAR_HD float Extrapolation(const PlanePoint& point,
                              const PlaneData& plane) const {
    if (plane.num_cells == 0) {
      return 1.f;
    }
    unsigned sectors = 0;
    float nearest = INFINITY;
    for (int i = 0; i < plane.num_cells; ++i) {
      const PlanePoint& cell = cells[plane.first_cell + i];
      const float s = cell.s - point.s;
      const float t = cell.t - point.t;
      const unsigned sector = (s > 0.f ? 1u : 0u) | (t > 0.f ? 2u : 0u) |
                              (fabsf(s) > fabsf(t) ? 4u : 0u);
      sectors |= 1u << sector;
      nearest = fminf(nearest, s * s + t * t);
    }
    int num_sectors = 0;
    for (int i = 0; i < 8; ++i) {
      num_sectors += static_cast<int>(sectors >> i & 1u);
    }
    const float openness = static_cast<float>(kSectorsKnown - num_sectors) /
                           (kSectorsKnown - kSectorsUnknown);
    const float reach = options.extrapolation_reach * plane.cell_size *
                        sqrtf(static_cast<float>(plane.num_cells));
    return fminf(fmaxf(openness, 0.f), 1.f) *
           fminf(sqrtf(nearest) / reach, 1.f);
  }
};

std::vector<PlaneData> MakePlaneData(const Camera& reference,
                                     const DiscoveredPlanes& discovered,
                                     const PlaneSupport& support) {
  std::vector<PlaneData> planes;
  for (size_t k = 0; k < discovered.planes.size(); ++k) {
    PlaneData data;
    data.plane = ToCameraPlane(discovered.planes[k].plane, reference);
    data.frame = support.frames[k];
    data.first_cell = support.first_cell[k];
    data.num_cells = support.first_cell[k + 1] - support.first_cell[k];
    data.cell_size = support.cell_sizes[k];
    planes.push_back(data);
  }
  return planes;
}

// groups: the pixels of the superpixels, in main memory.
std::vector<SuperpixelData> MakeSuperpixelData(const ViewEvidence& evidence,
                                               const Intrinsics& intrinsics,
                                               const std::vector<int>& begin,
                                               const std::vector<int>& pixels) {
  std::vector<SuperpixelData> superpixels;
  for (size_t s = 0; s < evidence.mass.size(); ++s) {
    SuperpixelData data;
    data.first_observation = evidence.first_observation[s];
    data.num_observations =
        evidence.first_observation[s + 1] - data.first_observation;
    data.first_pixel = begin[s];
    data.num_pixels = begin[s + 1] - begin[s];
    data.mass = evidence.mass[s];
    for (int i = 0; i < data.num_observations; ++i) {
      data.quality +=
          evidence.observations[static_cast<size_t>(data.first_observation + i)]
              .quality;
    }
    double x = 0.0;
    double y = 0.0;
    for (int i = begin[s]; i < begin[s + 1]; ++i) {
      x += pixels[static_cast<size_t>(i)] % evidence.width;
      y += pixels[static_cast<size_t>(i)] / evidence.width;
    }
    const int count = std::max(data.num_pixels, 1);
    data.ray = intrinsics.Ray(static_cast<float>(x / count),
                              static_cast<float>(y / count));
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
  return {depths[static_cast<size_t>(last * kDepthQuantile)] * kDepthMargin,
          depths[static_cast<size_t>(last * (1.0 - kDepthQuantile))] /
              kDepthMargin};
}

// What a border costs for each pair of labels, the last of which is 'none'.
class BorderCosts {
 public:
  BorderCosts(const ViewEvidence& evidence,
              const Intrinsics& intrinsics,
              const DisparityScale& scale,
              const std::vector<PlaneData>& planes,
              float full_gap)
      : borders_(evidence.borders),
        scale_(scale),
        full_gap_(full_gap),
        num_planes_(static_cast<int>(planes.size())) {
    constexpr auto kNumPixels =
        static_cast<size_t>(SuperpixelBorder::kNumPixels);
    depths_.resize(borders_.size() * planes.size() * kNumPixels);
    float* depth = depths_.data();
    for (const SuperpixelBorder& border : borders_) {
      for (const PlaneData& plane : planes) {
        for (const int pixel : border.pixels) {
          *depth++ = plane.plane.Depth(
              intrinsics.Ray(pixel % evidence.width, pixel / evidence.width));
        }
      }
    }
  }

  float operator()(int edge, int a, int b) const {
    if (a == b) {
      return 0.f;
    }
    const float weight = borders_[static_cast<size_t>(edge)].weight;
    if (a == num_planes_ || b == num_planes_) {
      return weight;
    }
    const float* first = Depths(edge, a);
    const float* second = Depths(edge, b);
    float sum = 0.f;
    for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
      const float nearer = std::min(first[i], second[i]);
      if (!(nearer > 0.f)) {
        sum += 1.f;
        continue;
      }
      const float gap = std::abs(first[i] - second[i]) /
                        (nearer * scale_.RelativeDepthError(nearer));
      sum += std::min(gap / full_gap_, 1.f);
    }
    return weight * sum / SuperpixelBorder::kNumPixels;
  }

 private:
  const float* Depths(int edge, int plane) const {
    return depths_.data() +
           (static_cast<size_t>(edge) * static_cast<size_t>(num_planes_) +
            static_cast<size_t>(plane)) *
               SuperpixelBorder::kNumPixels;
  }

  const std::vector<SuperpixelBorder>& borders_;
  DisparityScale scale_;
  float full_gap_;
  int num_planes_;
  // Of each plane at the pixels of each border.
  std::vector<float> depths_;
};

Image<PlaneCost> ComputeCosts(const std::vector<ObservedView>& views,
                              const std::vector<PlaneData>& planes,
                              const PlaneSupport& support,
                              const LabelOptions& options,
                              Device& device) {
  const ViewEvidence& evidence = *views[0].evidence;
  const Intrinsics intrinsics = views[0].camera.GetIntrinsics();
  Image<int> labels =
      Image<int>::Uninitialized(evidence.width, evidence.height);
  std::copy(
      evidence.superpixels.begin(), evidence.superpixels.end(), labels.begin());
  const PixelGroups groups =
      GroupPixels(DeviceImage<int>(device, labels).View(),
                  evidence.NumSuperpixels(),
                  device);
  const Buffer<SuperpixelData> superpixels(
      device,
      MakeSuperpixelData(
          evidence, intrinsics, groups.begin.ToHost(), groups.pixels.ToHost()));
  std::vector<DeviceImage<float>> strong_depths;
  std::vector<Witness> witnesses;
  for (size_t j = 1; j < views.size(); ++j) {
    strong_depths.emplace_back(device, views[j].evidence->strong_depth);
    witnesses.push_back(
        {views[j].camera.GetIntrinsics(),
         ComputeRelativePose(views[0].camera, views[j].camera),
         DisparityScale{0.f, views[j].evidence->error_per_depth},
         std::as_const(strong_depths.back()).View()});
  }
  const Buffer<Witness> device_witnesses(device, witnesses);
  const Buffer<PlaneData> device_planes(device, planes);
  const Buffer<Observation> observations(device, evidence.observations);
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
                         groups.pixels.Data(),
                         cells.Data(),
                         device_witnesses.Data(),
                         static_cast<int>(witnesses.size()),
                         evidence.width,
                         intrinsics,
                         DisparityScale{0.f, evidence.error_per_depth},
                         min_depth,
                         max_depth,
                         options,
                         costs.View()});
  return costs.ToHost();
}

// What a superpixel costs that has no plane.
float CostOfNone(float mass, float num_pixels, const LabelOptions& options) {
  return options.cost_of_unexplained * mass +
         options.cost_of_none * std::max(num_pixels - mass, 0.f);
}

}  // namespace

LabeledView LabelView(const std::vector<ObservedView>& views,
                      const DiscoveredPlanes& discovered,
                      const PlaneSupport& support,
                      const LabelOptions& options,
                      Device& device) {
  const ViewEvidence& evidence = *views[0].evidence;
  const int num_superpixels = evidence.NumSuperpixels();
  const int num_planes = static_cast<int>(discovered.planes.size());
  LabeledView result;
  result.labels.assign(static_cast<size_t>(num_superpixels), -1);
  result.evidence.assign(static_cast<size_t>(num_superpixels),
                         LabelEvidence::kNone);
  if (num_planes == 0 || num_superpixels == 0) {
    return result;
  }
  const std::vector<PlaneData> planes =
      MakePlaneData(views[0].camera, discovered, support);
  for (const PlaneData& plane : planes) {
    result.planes.push_back(plane.plane);
  }
  const Image<PlaneCost> costs =
      ComputeCosts(views, planes, support, options, device);
  std::vector<float> num_pixels(static_cast<size_t>(num_superpixels), 0.f);
  for (const uint16_t label : evidence.superpixels) {
    ++num_pixels[label];
  }
  LabelGraph graph;
  graph.num_nodes = num_superpixels;
  graph.num_labels = num_planes + 1;
  for (int s = 0; s < num_superpixels; ++s) {
    for (int k = 0; k < num_planes; ++k) {
      graph.unary.push_back(costs(k, s).cost);
    }
    const auto i = static_cast<size_t>(s);
    graph.unary.push_back(CostOfNone(evidence.mass[i], num_pixels[i], options));
  }
  for (const SuperpixelBorder& border : evidence.borders) {
    graph.edges.push_back({border.first, border.second});
  }
  const BorderCosts border_costs(evidence,
                                 views[0].camera.GetIntrinsics(),
                                 DisparityScale{0.f, evidence.error_per_depth},
                                 planes,
                                 options.full_gap);
  graph.pairwise = [&](int edge, int a, int b) {
    return border_costs(edge, a, b);
  };
  const std::vector<int> labels = MinimizeByExpansion(graph, options.expansion);
  for (int s = 0; s < num_superpixels; ++s) {
    const int k = labels[static_cast<size_t>(s)];
    if (k == num_planes) {
      continue;
    }
    result.labels[static_cast<size_t>(s)] = k;
    result.evidence[static_cast<size_t>(s)] =
        costs(k, s).explained > 0.f   ? LabelEvidence::kMeasured
        : costs(k, s).confirmed > 0.f ? LabelEvidence::kCarried
                                      : LabelEvidence::kGuessed;
  }
  return result;
}

}  // namespace tsar
