// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_view.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/view/refined_maps.h"

#include <cmath>

namespace tsar {
namespace {

// Depths that are larger by this many of the largest errors belong to another
// surface.
constexpr float kOtherSurfaceErrors = 4.f;
// Below this cosine between the ray and its normal, a plane does not determine
// the depth along the ray.
constexpr float kMinCosine = 0.1f;
// The ratio of the steps of pixel size by which the image is chosen whose
// pixels become points; well above the differences of depths that agree.
constexpr float kSizeStep = 1.5f;
constexpr int kMaxSizeSteps = 200;
// An image that sees through a point lowers the odds that it is right as much
// as so many that agree raise them.
constexpr float kWeightOfContradiction = 3.f;

struct Source {
  ImageView<const FusionPixel> pixels;
  Intrinsics intrinsics;
  RelativePose to_source;
  RelativePose from_source;
  int may_own;
  int comes_first;
};

struct Thresholds {
  int weights_depths;
  int min_num_views;
  float max_squared_reproj_error;
  float max_depth_error;
  float min_normal_cosine;
  int reject_contradicted;
  int spacing;
};

TSAR_HD float ConfidenceOf(const FusionPixel& pixel) {
  return ConfidenceOfLevel(pixel.confidence);
}

// The size of a pixel on the surface, in powers of kSizeStep, rounded down.
TSAR_HD int SizeStep(float size) {
  int step = 0;
  for (; size >= kSizeStep && step < kMaxSizeSteps; ++step) {
    size *= 1.f / kSizeStep;
  }
  for (; size < 1.f && step > -kMaxSizeSteps; --step) {
    size *= kSizeStep;
  }
  return step;
}

// A pixel's depth according to one image, and its weight.
struct Vote {
  float depth;
  float weight;
};

// The votes of the images that agree on one pixel.
struct Votes {
  TSAR_HD void Add(const FusionPixel& pixel, const Vec3f& normal, Vote vote) {
    ++count;
    weighted_depth += vote.weight * vote.depth;
    weight += vote.weight;
    normals = normals + normal;
    red += pixel.color.r;
    green += pixel.color.g;
    blue += pixel.color.b;
  }

  int count = 0;
  float weighted_depth = 0.f;
  float weight = 0.f;
  Vec3f normals;
  int red = 0;
  int green = 0;
  int blue = 0;
};

struct FuseKernel {
  ImageView<const FusionPixel> pixels;
  Intrinsics intrinsics;
  const Source* sources;
  int num_sources;
  Thresholds thresholds;
  ImageView<FusedPoint> points;
  int* is_point;  // One flag per point.

  TSAR_HD void operator()(int column, int row) const {
    const int x = Middle(column, pixels.width);
    const int y = Middle(row, pixels.height);
    FusedPoint point;
    if (pixels(x, y).depth > 0.f) {
      Fuse(x, y, &point);
    }
    points(column, row) = point;
    is_point[points.Index(column, row)] = point.column >= 0 ? 1 : 0;
  }

 private:
  enum class Opinion { kNone, kAgrees, kSeesThrough };

  // A source's opinion on a pixel's point.
  struct Answer {
    Opinion opinion = Opinion::kNone;
    FusionPixel pixel;  // The source's own.
    // The point and the normal of that pixel, where it agrees, in the frame of
    // the image.
    Vec3f point;
    Vec3f normal;
  };

  // The middle pixel of a square along one side; the last may be cut off.
  TSAR_HD int Middle(int square, int num_pixels) const {
    const int middle = square * thresholds.spacing + thresholds.spacing / 2;
    return middle < num_pixels ? middle : num_pixels - 1;
  }

  TSAR_HD Answer Ask(const Source& source,
                     int x,
                     int y,
                     const Vec3f& point,
                     const Vec3f& normal) const {
    Answer answer;
    const Vec3f there = source.to_source * point;
    int column = 0;
    int row = 0;
    if (!FindPixel(source.intrinsics,
                   source.pixels.width,
                   source.pixels.height,
                   there,
                   &column,
                   &row)) {
      return answer;
    }
    answer.pixel = source.pixels(column, row);
    const float depth = answer.pixel.depth;
    if (!(depth > 0.f)) {
      return answer;
    }
    const float error = (depth - there.z) / depth;
    if (fabsf(error) > thresholds.max_depth_error) {
      if (error > kOtherSurfaceErrors * thresholds.max_depth_error) {
        answer.opinion = Opinion::kSeesThrough;
      }
      return answer;
    }
    answer.point =
        source.from_source * (source.intrinsics.Ray(static_cast<float>(column),
                                                    static_cast<float>(row)) *
                              depth);
    if (!(answer.point.z > 0.f)) {
      return answer;
    }
    float u = 0.f;
    float v = 0.f;
    intrinsics.Project(answer.point, &u, &v);
    const float dx = u - static_cast<float>(x);
    const float dy = v - static_cast<float>(y);
    if (!(dx * dx + dy * dy <= thresholds.max_squared_reproj_error)) {
      return answer;
    }
    answer.normal = source.from_source.rotation * DecodeNormal(answer.pixel);
    if (AreAlike(normal, answer.normal)) {
      answer.opinion = Opinion::kAgrees;
    }
    return answer;
  }

  // An unknown normal is similar to any.
  TSAR_HD bool AreAlike(const Vec3f& a, const Vec3f& b) const {
    const Vec3f unknown;
    return a == unknown || b == unknown ||
           Dot(a, b) >= thresholds.min_normal_cosine;
  }

  // Whether the surface is assigned to the source.
  TSAR_HD bool IsOwnedBy(const Source& source,
                         const FusionPixel& theirs,
                         int own_step) const {
    if (source.may_own == 0) {
      return false;
    }
    const int their_step = SizeStep(theirs.depth / source.intrinsics.fx);
    return their_step < own_step ||
           (their_step == own_step && source.comes_first != 0);
  }

  // By the relative precision: depths that agree are about equal.
  TSAR_HD float WeightOf(const FusionPixel& pixel) const {
    if (thresholds.weights_depths == 0) {
      return 1.f;
    }
    const float sigma = static_cast<float>(pixel.sigma) * kSigmaStep;
    return ConfidenceOf(pixel) / (sigma * sigma);
  }

  // The depth of the source's plane along the ray, or that of its point where
  // the plane does not determine it.
  TSAR_HD Vote VoteOf(const Answer& answer, const Vec3f& ray) const {
    const float z = answer.point.z;
    const float cosine = Dot(answer.normal, ray);
    const float on_plane = Dot(answer.normal, answer.point) / cosine;
    const bool is_usable =
        fabsf(cosine) > kMinCosine * Norm(ray) &&
        fabsf(on_plane - z) <= thresholds.max_depth_error * z;
    return {is_usable ? on_plane : z, WeightOf(answer.pixel)};
  }

  TSAR_HD void Fuse(int x, int y, FusedPoint* fused) const {
    const FusionPixel own = pixels(x, y);
    const Vec3f ray =
        intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
    const Vec3f point = ray * own.depth;
    const Vec3f normal = DecodeNormal(own);
    Votes votes;
    votes.Add(own, normal, {own.depth, WeightOf(own)});
    const int own_step = SizeStep(own.depth / intrinsics.fx);
    float agreeing = ConfidenceOf(own);
    float contradicting = 0.f;
    uint64_t agreeing_sources = 0;
    for (int s = 0; s < num_sources; ++s) {
      const Answer answer = Ask(sources[s], x, y, point, normal);
      if (answer.opinion == Opinion::kAgrees) {
        if (IsOwnedBy(sources[s], answer.pixel, own_step)) {
          return;
        }
        votes.Add(answer.pixel, answer.normal, VoteOf(answer, ray));
        agreeing += ConfidenceOf(answer.pixel);
        agreeing_sources |= uint64_t{1} << s;
      } else if (answer.opinion == Opinion::kSeesThrough) {
        contradicting += ConfidenceOf(answer.pixel);
      }
    }
    if (votes.count < thresholds.min_num_views ||
        (thresholds.reject_contradicted != 0 &&
         kWeightOfContradiction * contradicting > agreeing)) {
      return;
    }
    fused->position = ray * (votes.weighted_depth / votes.weight);
    fused->normal = Normalized(votes.normals);
    const int half = votes.count / 2;
    fused->color = {static_cast<uint8_t>((votes.red + half) / votes.count),
                    static_cast<uint8_t>((votes.green + half) / votes.count),
                    static_cast<uint8_t>((votes.blue + half) / votes.count)};
    fused->column = x;
    fused->row = y;
    fused->sources = agreeing_sources;
  }
};

struct CompactKernel {
  const FusedPoint* points;
  const int* first;  // The number of points before each.
  FusedPoint* compact;

  TSAR_HD void operator()(int64_t i) const {
    if (points[i].column >= 0) {
      compact[first[i]] = points[i];
    }
  }
};

int NumSquares(int num_pixels, int spacing) {
  return (num_pixels + spacing - 1) / spacing;
}

}  // namespace

std::vector<FusedPoint> FuseView(const FusionInput& view,
                                 int place,
                                 const std::vector<FusionSourceInput>& sources,
                                 const FusionOptions& options,
                                 Device& device) {
  std::vector<Source> inputs;
  for (const FusionSourceInput& source : sources) {
    inputs.push_back({source.view.pixels,
                      source.view.camera.GetIntrinsics(),
                      ComputeRelativePose(view.camera, source.view.camera),
                      ComputeRelativePose(source.view.camera, view.camera),
                      source.may_own ? 1 : 0,
                      source.place < place ? 1 : 0});
  }
  const Buffer<Source> device_sources(device, inputs);
  const int width = NumSquares(view.pixels.width, options.point_spacing);
  const int height = NumSquares(view.pixels.height, options.point_spacing);
  DeviceImage<FusedPoint> points(device, width, height);
  Buffer<int> is_point(device, points.View().NumPixels());
  const float max_reproj_error = static_cast<float>(options.max_reproj_error);
  ParallelFor(device,
              width,
              height,
              FuseKernel{view.pixels,
                         view.camera.GetIntrinsics(),
                         device_sources.Data(),
                         static_cast<int>(inputs.size()),
                         {options.weights_depths ? 1 : 0,
                          options.min_num_views,
                          max_reproj_error * max_reproj_error,
                          static_cast<float>(options.max_depth_error),
                          static_cast<float>(std::cos(options.max_normal_error *
                                                      M_PI / 180.0)),
                          options.reject_contradicted ? 1 : 0,
                          options.point_spacing},
                         points.View(),
                         is_point.Data()});
  const Buffer<int> first =
      ExclusiveSum(is_point.Data(), is_point.Size(), device);
  int count = 0;
  device.CopyToHost(&count, first.Data() + is_point.Size(), sizeof(count));
  Buffer<FusedPoint> compact(device, static_cast<size_t>(count));
  ParallelFor(device,
              static_cast<int64_t>(is_point.Size()),
              CompactKernel{points.View().data, first.Data(), compact.Data()});
  return compact.ToHost();
}

}  // namespace tsar
