// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/planar_prior.h"

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/priors/prior_likelihood.h"
#include "colmap_tsar/priors/prior_raster.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"
#include "colmap_tsar/tools/stereo/stereo_views.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// The least side of the squares, in pixels, which grow with the size of large
// images so that there are at most 100,000.
constexpr int kMinSquareSide = 5;
constexpr int kImageSidePerSquareSide = 256;
// The least share of a square's pixels with a depth.
constexpr float kMinDensity = 0.25f;

// The least NCC of a reliable depth: only textured windows match this well, and
// a prior tolerates less exact points than maps do.
constexpr float kMinNcc = 0.7f;
constexpr float kMinTriangulationAngle = 1.f;
constexpr int kMinNumConsistent = 2;

struct Pixel {
  int x = 0;
  int y = 0;
};

// The pixel with the median depth of the square at (x0, y0).
std::optional<Pixel> MedianOfSquare(const Image<float>& depth,
                                    int x0,
                                    int y0,
                                    int side) {
  std::vector<std::pair<float, size_t>> depths;
  for (int y = y0; y < std::min(y0 + side, depth.Height()); ++y) {
    for (int x = x0; x < std::min(x0 + side, depth.Width()); ++x) {
      if (depth(x, y) > 0.f) {
        depths.emplace_back(depth(x, y), depth.View().Index(x, y));
      }
    }
  }
  if (static_cast<float>(depths.size()) <
      kMinDensity * static_cast<float>(side * side)) {
    return std::nullopt;
  }
  const auto median =
      depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::ranges::nth_element(depths, median);
  const size_t width = static_cast<size_t>(depth.Width());
  return Pixel{static_cast<int>(median->second % width),
               static_cast<int>(median->second / width)};
}

std::vector<cv::Point2f> SelectVertices(const Image<float>& depth) {
  const int side = std::max(
      kMinSquareSide,
      std::max(depth.Width(), depth.Height()) / kImageSidePerSquareSide);
  std::vector<cv::Point2f> vertices;
  for (int y = 0; y < depth.Height(); y += side) {
    for (int x = 0; x < depth.Width(); x += side) {
      if (const auto pixel = MedianOfSquare(depth, x, y, side)) {
        vertices.emplace_back(static_cast<float>(pixel->x),
                              static_cast<float>(pixel->y));
      }
    }
  }
  return vertices;
}

using Triangle = std::array<Pixel, 3>;

// Twice the signed area of the triangle a, b, c; exact, so that adjacent
// triangles leave no pixel between them.
int64_t SignedArea(const Pixel& a, const Pixel& b, const Pixel& c) {
  return int64_t{b.x - a.x} * (c.y - a.y) - int64_t{c.x - a.x} * (b.y - a.y);
}

// The largest integer not above numerator / denominator; denominator > 0.
int64_t FloorOfRatio(int64_t numerator, int64_t denominator) {
  const int64_t quotient = numerator / denominator;
  return quotient - (numerator % denominator < 0 ? 1 : 0);
}

// Sets the pixels in the triangle and on its sides, row by row, since long
// slivers fill little of their bounding box.
void FillTriangle(const Triangle& triangle,
                  const Plane& plane,
                  Image<Plane>* planes) {
  const auto& [a, b, c] = triangle;
  const int64_t sign = SignedArea(a, b, c) < 0 ? -1 : 1;
  const auto [first, last] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  for (int y = top; y <= bottom; ++y) {
    int64_t x_min = first;
    int64_t x_max = last;
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
      // On this side of the edge: value + slope * x >= 0.
      const int64_t slope = -sign * (to.y - from.y);
      const int64_t value = sign * SignedArea(from, to, {0, y});
      if (slope > 0) {
        x_min = std::max(x_min, -FloorOfRatio(value, slope));
      } else if (slope < 0) {
        x_max = std::min(x_max, FloorOfRatio(value, -slope));
      }
    }
    for (int64_t x = x_min; x <= x_max; ++x) {
      (*planes)(static_cast<int>(x), y) = plane;
    }
  }
}

// The corners; nullopt for the outer triangles of the subdivision.
std::optional<Triangle> CornersInImage(const cv::Vec6f& corners,
                                       const Image<float>& depth) {
  Triangle triangle;
  for (int i = 0; i < 3; ++i) {
    const float x = corners[2 * i];
    const float y = corners[2 * i + 1];
    if (!(x >= 0.f && y >= 0.f && x < static_cast<float>(depth.Width()) &&
          y < static_cast<float>(depth.Height()))) {
      return std::nullopt;
    }
    Pixel& corner = triangle[i];
    corner = {static_cast<int>(x), static_cast<int>(y)};
    if (!(depth(corner.x, corner.y) > 0.f)) {
      return std::nullopt;
    }
  }
  return triangle;
}

// The reliable depths on texture, on the raster of a refinement.
Image<RayDepth> SampleTexturedDepths(const ViewData& reference,
                                     const DeviceImage<float>& reliable_depth,
                                     Device& device) {
  const ReducedRaster raster =
      MakeRaster(reliable_depth.Width(), reliable_depth.Height());
  const DeviceImage<Rgb> color(device, reference.color);
  const DeviceImage<Rgb> reduced =
      MakeRasterColor(color.View(), raster, /*denoise=*/true, device);
  const DeviceImage<float> gray = ComputeGray(reduced.View(), device);
  const Image<float> depth =
      ReduceNearest(reliable_depth.View(), raster, device).ToHost();
  const Intrinsics intrinsics =
      reference.camera.Resized(raster.width, raster.height).GetIntrinsics();
  Image<RayDepth> samples(raster.width, raster.height);
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const Vec3f ray = intrinsics.Ray(x, y);
      samples(x, y) = {ray.x, ray.y, depth(x, y)};
    }
  }
  return SamplesToAlignBy(std::move(samples),
                          ComputeTexture(gray.View(), device).ToHost(),
                          /*fattening_weight=*/{});
}

// A second one changes the clouds by 0.003 at most.
constexpr int kNumIterations = 1;
// One confirming view suffices here; fusion requires more.
constexpr int kMinNumConfirming = 1;

bool IsFilled(const ViewData& view, size_t pixel) {
  return view.depth.Data()[pixel] > 0.f &&
         view.min_cost.Data()[pixel] == kUndefinedCost;
}

// The planes of the filled pixels, invalid elsewhere.
Image<Plane> PriorOf(const ViewData& view, const Intrinsics& intrinsics) {
  Image<Plane> prior(view.depth.Width(), view.depth.Height());
  for (int y = 0; y < prior.Height(); ++y) {
    for (int x = 0; x < prior.Width(); ++x) {
      if (IsFilled(view, view.depth.View().Index(x, y))) {
        prior(x, y) = Plane::FromPoint(
            intrinsics.Ray(x, y), view.depth(x, y), view.normal(x, y));
      }
    }
  }
  return prior;
}

Image<uint8_t> PixelsThatKeepTheirPlane(const ViewData& view) {
  Image<uint8_t> keeps_plane(view.depth.Width(), view.depth.Height());
  for (size_t i = 0; i < keeps_plane.NumPixels(); ++i) {
    keeps_plane.Data()[i] = IsFilled(view, i) ? 0 : 1;
  }
  return keeps_plane;
}

// Merges measured pixels of the view with new maps of the filled ones.
StereoMaps Merge(const ViewData& view,
                 const Image<float>& depth,
                 const Image<Vec3f>& normal) {
  StereoMaps maps{view.depth, view.normal, view.min_cost, view.second_cost};
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    if (IsFilled(view, i)) {
      const bool is_kept = depth.Data()[i] > 0.f;
      maps.depth.Data()[i] = is_kept ? depth.Data()[i] : 0.f;
      maps.normal.Data()[i] = is_kept ? normal.Data()[i] : Vec3f{};
      maps.min_cost.Data()[i] = kCostWithoutEvidence;
      maps.second_cost.Data()[i] = kCostWithoutEvidence;
    }
  }
  return maps;
}

}  // namespace

Image<Plane> TriangulatePlanes(const Image<float>& depth,
                               const Intrinsics& intrinsics) {
  Image<Plane> planes(depth.Width(), depth.Height());
  const std::vector<cv::Point2f> vertices = SelectVertices(depth);
  if (vertices.size() < 3) {
    return planes;
  }
  cv::Subdiv2D subdivision(cv::Rect(0, 0, depth.Width(), depth.Height()));
  subdivision.insert(vertices);
  std::vector<cv::Vec6f> triangles;
  subdivision.getTriangleList(triangles);
  const auto point = [&](const Pixel& pixel) {
    return intrinsics.Ray(pixel.x, pixel.y) * depth(pixel.x, pixel.y);
  };
  for (const cv::Vec6f& corners : triangles) {
    const std::optional<Triangle> triangle = CornersInImage(corners, depth);
    if (!triangle) {
      continue;
    }
    const auto& [a, b, c] = *triangle;
    const Plane plane = Plane::FromPoints(point(a), point(b), point(c));
    if (plane.Valid()) {
      FillTriangle(*triangle, plane, &planes);
    }
  }
  return planes;
}

DeviceImage<float> FindReliableDepth(const ReferenceView& reference,
                                     const Buffer<SourceView>& sources,
                                     float window_radius,
                                     Device& device) {
  HypothesisFilterOptions reliable;
  reliable.min_ncc = kMinNcc;
  reliable.min_triangulation_angle = kMinTriangulationAngle;
  reliable.min_num_consistent =
      std::clamp(static_cast<int>(sources.Size()), 1, kMinNumConsistent);
  reliable.window_radius = window_radius;
  return FilterHypotheses(reference, sources, {}, reliable, device);
}

PriorAssessment UseDepthPrior(const ViewData& reference,
                              const DeviceImage<float>& reliable_depth,
                              Device& device,
                              Image<Plane>* planes) {
  const AlignedPrior aligned =
      AlignPrior(*reference.prior,
                 SampleTexturedDepths(reference, reliable_depth, device));
  if (aligned.Empty()) {
    return aligned.assessment;
  }
  const auto min_probability =
      static_cast<float>(RefineOptions().min_fill_confidence);
  const Intrinsics intrinsics = reference.camera.GetIntrinsics();
  const PriorRaster prior{aligned.depth.View(),
                          aligned.sigma.View(),
                          aligned.outlier_share,
                          intrinsics,
                          planes->Width(),
                          planes->Height()};
  for (int y = 0; y < planes->Height(); ++y) {
    for (int x = 0; x < planes->Width(); ++x) {
      const PriorDepth at = prior.At(x, y);
      if (!(at.depth > 0.f) || ProbabilityOfSurface(at) < min_probability) {
        continue;
      }
      // A plane that the prior does not contradict is more exact: measured.
      Plane& plane = (*planes)(x, y);
      const Vec3f ray = intrinsics.Ray(x, y);
      if (plane.Valid() && LogLikelihoodRatio(at, plane.Depth(ray)) >= 0.f) {
        continue;
      }
      plane = Plane::FromPoint(ray, at.depth, prior.NormalAt(x, y));
    }
  }
  return aligned.assessment;
}

void FillWithPrior(const Image<Plane>& prior,
                   const Intrinsics& intrinsics,
                   const DepthInterval& range,
                   StereoMaps* maps) {
  for (int y = 0; y < prior.Height(); ++y) {
    for (int x = 0; x < prior.Width(); ++x) {
      const Plane& plane = prior(x, y);
      if (maps->depth(x, y) > 0.f || !plane.Valid()) {
        continue;
      }
      const float depth = plane.Depth(intrinsics.Ray(x, y));
      if (depth >= range.min && depth <= range.max) {
        maps->depth(x, y) = depth;
        maps->normal(x, y) = plane.normal;
        maps->min_cost(x, y) = kUndefinedCost;
        maps->second_cost(x, y) = kUndefinedCost;
      }
    }
  }
}

StereoMaps MatchUnderPrior(const ViewData& reference,
                           const std::vector<const ViewData*>& sources,
                           const DepthInterval& range,
                           uint32_t stream,
                           const StereoOptions& options,
                           Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const Buffer<SourceView> source_views = views.Sources(0);
  const ReferenceView view = views.Reference(0);
  PatchMatchOptions search = SearchOptions(options, range);
  search.num_past_iterations = options.num_iterations - 1;
  search.num_iterations = kNumIterations;
  const DeviceImage<Plane> prior(device, PriorOf(reference, view.intrinsics));
  const DeviceImage<uint8_t> keeps_plane(device,
                                         PixelsThatKeepTheirPlane(reference));
  PatchMatchInputs inputs{view, source_views, StreamOf(stream, kUnderPrior)};
  inputs.prior = prior.View();
  inputs.keeps_plane = keeps_plane.View();
  DepthNormalImages maps = UpdateMaps(reference, inputs, search, device);
  HypothesisFilterOptions filter =
      FilterOptions(options, static_cast<int>(sources.size()));
  filter.min_num_consistent =
      std::min(filter.min_num_consistent, kMinNumConfirming);
  FilterMaps(inputs, filter, options.smooth_normals, device, &maps);
  return Merge(reference, maps.depth.ToHost(), maps.normal.ToHost());
}

}  // namespace tsar
