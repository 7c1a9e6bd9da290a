// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/photometric_offset.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/view/denoise/window_variance.h"

#include <cmath>
#include <cstdint>

namespace tsar {
namespace {

// The largest standard deviation of an offset by its texture, and the largest
// difference of the offsets of two halves of the sources, in pixels of
// disparity.
constexpr float kMaxSigma = 0.1f;
constexpr float kMaxDifferenceOfHalves = 0.2f;
constexpr int kMinNumSources = 4;
// The least texture of the pixel itself, in variances of the noise.
constexpr float kMinTexture = 8.f;
// The largest distance from the pixel of the centroid of the texture that
// determines the offset.
constexpr float kMaxTextureDistance = 1.25f;
// The window is wide enough for NCC to be robust to noise, and small enough for
// detail.
constexpr float kWindowRadius = 3.f;
constexpr float kStep = 0.25f;  // In pixels of disparity.
// Offsets are tried beyond kMaxPhotometricOffset: where the last one is the
// best, it is another surface.
constexpr int kNumSteps = 5;  // To either side.
constexpr int kNumOffsets = 2 * kNumSteps + 1;
// The part of 1 - NCC^2 by interpolation and surfaces that are not flat, in
// addition to noise.
constexpr float kModelError = 0.02f;
// A pixel is occluded in a source with a surface nearer than this share of the
// depth.
constexpr float kHidden = 0.97f;
// Least distance from the border of a source, in pixels.
constexpr float kMargin = 3.f;
// Lower bound of the standard deviation of an offset.
constexpr float kMinSigma = 0.02f;

// Log-likelihood by offset.
struct OffsetCurve {
  float value[kNumOffsets] = {};

  TSAR_HD int Best() const {
    int best = 0;
    for (int i = 1; i < kNumOffsets; ++i) {
      best = value[i] > value[best] ? i : best;
    }
    return best;
  }
  // The curvature at an offset that is not the first or last.
  TSAR_HD float Curvature(int i) const {
    return 2.f * value[i] - value[i - 1] - value[i + 1];
  }
  // The peak of the parabola there, in steps.
  TSAR_HD float Peak(int i) const {
    const float curvature = Curvature(i);
    return static_cast<float>(i) +
           (curvature > 0.f ? 0.5f * (value[i + 1] - value[i - 1]) / curvature
                            : 0.f);
  }
};

TSAR_HD inline bool IsAtEnd(int offset) {
  return offset == 0 || offset == kNumOffsets - 1;
}

// Sums over sources of the products of e, the motion of a pixel along its
// epipolar line per pixel of disparity, which give the information of gradients
// about an offset.
struct EpipolarMotion {
  float xx = 0.f;
  float xy = 0.f;
  float yy = 0.f;

  TSAR_HD void Add(float x, float y) {
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  TSAR_HD float Information(float dx, float dy) const {
    return xx * dx * dx + 2.f * xy * dx * dy + yy * dy * dy;
  }
};

struct OffsetKernel {
  Intrinsics intrinsics;
  ImageView<const float> gray;
  const SourceView* sources;
  int num_sources;
  DepthResolution resolution;
  NoiseCurve noise;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  ImageView<const uint8_t> provenance;
  ImageView<float> offsets;
  ImageView<float> weights;

  TSAR_HD void operator()(int x, int y) const {
    float offset = 0.f;
    weights(x, y) = Measure(x, y, &offset);
    offsets(x, y) = offset;
  }

  TSAR_HD float Measure(int x, int y, float* offset) const {
    const float own = depth(x, y);
    if (!(own > 0.f) ||
        provenance(x, y) != static_cast<uint8_t>(Provenance::kMeasured)) {
      return PhotometricOffsets::kNeverMoves;
    }
    const float noise_variance = noise.Variance(gray(x, y));
    const Vec3f ray = intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, own, normal(x, y));
    if (!(OwnTexture(gray, x, y) > kMinTexture * noise_variance) ||
        !plane.Valid()) {
      return PhotometricOffsets::kNeverMoves;
    }
    const ReferencePatch patch(gray, x, y, kWindowRadius);
    if (!patch.HasTexture()) {
      return 0.f;
    }
    const float unexplained =
        kModelError + 2.f * noise_variance / patch.GrayVariance();
    // Cheap tests come first: most pixels without an offset of their own fail
    // one.
    EpipolarMotion motion;
    uint32_t seen = 0;
    static_assert(kMaxPhotometricSources <= 32);
    int num_seen = 0;
    for (int s = 0; s < num_sources; ++s) {
      if (AddMotion(sources[s], ray, own, &motion)) {
        seen |= uint32_t{1} << s;
        ++num_seen;
      }
    }
    if (num_seen < kMinNumSources || !IsAmidTexture(x, y, motion)) {
      return 0.f;
    }
    OffsetCurve halves[2];
    float peaks[2];
    for (int half = 0; half < 2; ++half) {
      int num_passed = 0;
      for (int s = 0; s < num_sources; ++s) {
        if ((seen >> s & 1u) != 0 && num_passed++ % 2 == half) {
          AddCurve(sources[s], patch, plane, own, unexplained, &halves[half]);
        }
      }
      const int best_of_half = halves[half].Best();
      if (IsAtEnd(best_of_half)) {
        return 0.f;
      }
      peaks[half] = halves[half].Peak(best_of_half);
    }
    OffsetCurve all;
    for (int i = 0; i < kNumOffsets; ++i) {
      all.value[i] = halves[0].value[i] + halves[1].value[i];
    }
    const int best = all.Best();
    if (IsAtEnd(best)) {
      return 0.f;
    }
    const float curvature = all.Curvature(best);
    *offset = kStep * (all.Peak(best) - static_cast<float>(kNumSteps));
    if (!(curvature * kMaxSigma * kMaxSigma > kStep * kStep) ||
        !(fabsf(*offset) <= kMaxPhotometricOffset) ||
        !(kStep * fabsf(peaks[0] - peaks[1]) <= kMaxDifferenceOfHalves)) {
      return 0.f;
    }
    return 1.f / fmaxf(kStep * kStep / curvature, kMinSigma * kMinSigma);
  }

  // Whether the source may see the surface; adds the motion of its projection.
  TSAR_HD bool AddMotion(const SourceView& source,
                         const Vec3f& ray,
                         float own,
                         EpipolarMotion* motion) const {
    const RelativePose& pose = source.from_reference;
    const Vec3f point = pose * (ray * own);
    const Vec3f moved = pose * (ray * DepthAtOffset(own, 1.f, resolution));
    if (!(point.z > 0.f) || !(moved.z > 0.f)) {
      return false;
    }
    float u = 0.f;
    float v = 0.f;
    source.intrinsics.Project(point, &u, &v);
    if (!(u >= kMargin) || !(v >= kMargin) ||
        !(u <= source.gray.width - 1 - kMargin) ||
        !(v <= source.gray.height - 1 - kMargin)) {
      return false;
    }
    if (source.depth.width > 0) {
      const float seen =
          source.depth(static_cast<int>(u + 0.5f), static_cast<int>(v + 0.5f));
      if (seen > 0.f && seen < kHidden * point.z) {
        return false;
      }
    }
    float moved_u = 0.f;
    float moved_v = 0.f;
    source.intrinsics.Project(moved, &moved_u, &moved_v);
    const float length =
        sqrtf((moved_u - u) * (moved_u - u) + (moved_v - v) * (moved_v - v));
    // The direction toward the source's epipole.
    const Vec3f center = -TransposeTimes(pose.rotation, pose.translation);
    const float along_x = intrinsics.fx * (center.x - ray.x * center.z);
    const float along_y = intrinsics.fy * (center.y - ray.y * center.z);
    const float norm = sqrtf(along_x * along_x + along_y * along_y);
    if (norm > 0.f) {
      motion->Add(length * along_x / norm, length * along_y / norm);
    }
    return true;
  }

  TSAR_HD void AddCurve(const SourceView& source,
                        const ReferencePatch& patch,
                        const Plane& plane,
                        float own,
                        float unexplained,
                        OffsetCurve* curve) const {
    float residuals[kNumOffsets];
    for (int i = 0; i < kNumOffsets; ++i) {
      const float at = DepthAtOffset(
          own, kStep * static_cast<float>(i - kNumSteps), resolution);
      const float cost = PatchCost(
          patch, intrinsics, source, {plane.normal, plane.offset * at / own});
      const float ncc = cost == kUndefinedCost ? 0.f : fmaxf(1.f - cost, 0.f);
      residuals[i] = fminf(1.f - ncc * ncc + unexplained, 1.f);
    }
    // A separate loop, which becomes vector instructions on a CPU.
    for (int i = 0; i < kNumOffsets; ++i) {
      curve->value[i] -= 0.5f * static_cast<float>(kPatchSize) *
                         NaturalLogarithm(residuals[i]);
    }
  }

  // Whether the gradients that determine the offset surround the pixel: next to
  // an edge, a window gets the depth of the edge.
  TSAR_HD bool IsAmidTexture(int x, int y, const EpipolarMotion& motion) const {
    constexpr int kRadius = 5;
    constexpr float kSigma = 2.f;
    float sum = 0.f;
    float sum_x = 0.f;
    float sum_y = 0.f;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        const float weight =
            ExpOfNegative(-static_cast<float>(dx * dx + dy * dy) /
                          (2.f * kSigma * kSigma)) *
            motion.Information(
                Gray(x + dx + 1, y + dy) - Gray(x + dx - 1, y + dy),
                Gray(x + dx, y + dy + 1) - Gray(x + dx, y + dy - 1));
        sum += weight;
        sum_x += weight * static_cast<float>(dx);
        sum_y += weight * static_cast<float>(dy);
      }
    }
    const float max_distance = kMaxTextureDistance * sum;
    return sum > 0.f &&
           sum_x * sum_x + sum_y * sum_y < max_distance * max_distance;
  }

  // The gray level, clamped to the border.
  TSAR_HD float Gray(int x, int y) const {
    x = x < 0 ? 0 : (x < gray.width ? x : gray.width - 1);
    y = y < 0 ? 0 : (y < gray.height ? y : gray.height - 1);
    return gray(x, y);
  }
};

}  // namespace

PhotometricOffsets MeasureOffsets(const ComposedMap& composed,
                                  const PhotometricInputs& inputs,
                                  Device& device) {
  const int width = composed.map.depth.Width();
  const int height = composed.map.depth.Height();
  PhotometricOffsets result{DeviceImage<float>(device, width, height),
                            DeviceImage<float>(device, width, height)};
  ParallelFor(device,
              width,
              height,
              OffsetKernel{inputs.intrinsics,
                           inputs.gray,
                           inputs.sources.Data(),
                           static_cast<int>(inputs.sources.Size()),
                           inputs.resolution,
                           inputs.noise,
                           composed.map.depth.View(),
                           composed.map.normal.View(),
                           composed.provenance.View(),
                           result.offset.View(),
                           result.weight.View()});
  return result;
}

}  // namespace tsar
