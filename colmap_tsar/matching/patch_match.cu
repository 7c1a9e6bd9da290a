// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/patch_match.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/patch_match_steps.cuh"

#include <cmath>
#include <string>

namespace tsar {
namespace {

// Views are selected in every second iteration, which costs the most: each
// candidate is then compared with all sources, whether they count or not.
constexpr int kSelectionPeriod = 2;

// The random numbers of a pixel in an iteration, whose blocks no other pixel or
// iteration shares.
TSAR_HD Philox PixelRandom(uint32_t stream, int64_t pixel, int iteration) {
  return Philox(
      stream, static_cast<uint32_t>(pixel), static_cast<uint32_t>(iteration));
}

// 2^-exponent.
TSAR_HD float PowerOfHalf(float exponent) {
  return ExpOfNegative(-0.693147181f * exponent);
}

// Numbers are drawn in separate statements, since compilers differ in the order
// of evaluation of arguments.
TSAR_HD Plane DrawPlane(const DepthBounds& bounds,
                        const Vec3f& ray,
                        Philox* random) {
  const float depth = bounds.Draw(random);
  const Vec3f normal = DrawNormal(ray, random);
  return Plane::FromPoint(ray, depth, normal);
}

struct DrawKernel {
  Intrinsics intrinsics;
  DepthBounds bounds;
  uint32_t stream;
  int width;

  TSAR_HD Plane operator()(int x, int y) const {
    Philox random = PixelRandom(
        stream, static_cast<int64_t>(y) * width + x, /*iteration=*/0);
    return DrawPlane(bounds, intrinsics.Ray(x, y), &random);
  }
};

// The sources' textures as a parameter of kernels. A texture must be the same
// in all threads of a warp; unless the compiler can tell, it has them take
// turns at every single sample.
struct SourceTextures {
  explicit SourceTextures(const SourceViews& sources) {
    for (int s = 0; s < sources.Size(); ++s) {
      of[s] = sources.Host()[s].gray.texture;
    }
  }

  uint64_t of[kMaxMatchedSources] = {};
};

// What the kernels have in common.
struct PlaneSearch {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;
  PatchMatchOptions options;
  SourceTextures textures;

  // 1 - NCC of a plane in a source. All threads must take the same source.
  TSAR_HD float Photometric(const PixelCosts& pixel,
                            int source,
                            const Plane& plane) const {
    GrayView gray = sources[source].gray;
    gray.texture = textures.of[source];
    return pixel.Photometric(sources[source], gray, plane);
  }

  TSAR_HD ReferencePatch PatchAt(int x, int y) const {
    return ReferencePatch(reference.gray, x, y, options.window_radius);
  }
  TSAR_HD PixelCosts CostsAt(int x, int y, const ReferencePatch& patch) const {
    return {reference, options, patch, reference.intrinsics.Ray(x, y)};
  }
};

// The cost of the pixels' planes before view selection: the mean of the two
// lowest costs of the sources.
struct FirstCostKernel : PlaneSearch {
  ImageView<const Plane> planes;
  ImageView<float> costs;

  TSAR_HD void operator()(int x, int y) const {
    const ReferencePatch patch = PatchAt(x, y);
    const PixelCosts pixel = CostsAt(x, y, patch);
    const float worst =
        kMaxCost + options.geometric_weight * options.max_geometric_error;
    float first = worst;
    float second = worst;
    const Plane plane = planes(x, y);
    if (!IsUsable(plane, pixel.ray, options)) {
      costs(x, y) = worst;
      return;
    }
    for (int s = 0; s < num_sources; ++s) {
      const float cost =
          Photometric(pixel, s, plane) + pixel.Geometric(sources[s], plane);
      if (cost < first) {
        second = first;
        first = cost;
      } else if (cost < second) {
        second = cost;
      }
    }
    costs(x, y) = 0.5f * (first + second);
  }
};

// Updates the pixels of one color of the checkerboard.
struct SweepKernel : PlaneSearch {
  // Eight blocks leave 64 registers for each thread.
  static constexpr int kMinBlocks = 8;

  uint32_t stream;
  int iteration;
  // Otherwise those of the iteration before stay selected.
  bool selects_views;
  int color;
  ImageView<const uint8_t> keeps_plane;
  ImageView<Plane> planes;
  ImageView<float> costs;
  // View weights by view and pixel.
  uint8_t* weights;

  TSAR_HD void operator()(int64_t i) const {
    const int half_width = (planes.width + 1) / 2;
    const int y = static_cast<int>(i / half_width);
    const int x = 2 * static_cast<int>(i % half_width) + ((y + color) & 1);
    if (x < planes.width && (keeps_plane.Empty() || keeps_plane(x, y) == 0)) {
      Update(x, y);
    }
  }

  TSAR_HD uint8_t& Weight(int view, int x, int y) const {
    return weights[(static_cast<int64_t>(view) * planes.height + y) *
                       planes.width +
                   x];
  }

  TSAR_HD void Update(int x, int y) const {
    const ReferencePatch patch = PatchAt(x, y);
    const PixelCosts pixel = CostsAt(x, y, patch);
    Plane best = planes(x, y);
    if (!IsUsable(best, pixel.ray, options)) {
      // The plane is invalid, or from another pixel at a smaller size.
      Philox random = PixelRandom(stream,
                                  static_cast<int64_t>(y) * planes.width + x,
                                  /*iteration=*/0);
      best =
          DrawPlane({options.depth_min, options.depth_max}, pixel.ray, &random);
    }
    float best_cost = costs(x, y);
    if (selects_views) {
      PropagateAndSelectViews(x, y, pixel, &best, &best_cost);
    }
    int sum_weights = 0;
    for (int s = 0; s < num_sources; ++s) {
      sum_weights += Weight(s, x, y);
    }
    const WeightedCosts weighted{
        *this, pixel, x, y, 1.f / static_cast<float>(sum_weights)};
    if (!selects_views) {
      Propagate(weighted, &best, &best_cost);
    }
    Refine(weighted, &best, &best_cost);
    planes(x, y) = best;
    costs(x, y) = best_cost;
  }

  // The plane of an area's best pixel; invalid outside of the image.
  TSAR_HD Plane PlaneOfArea(int x, int y, int area) const {
    PixelOffset from{};
    return BestOfArea(costs, x, y, area, &from) ? planes(from.x, from.y)
                                                : Plane{};
  }

  // Takes the best of the pixel's own plane and those of its neighbors, by the
  // views that these planes select.
  TSAR_HD void PropagateAndSelectViews(int x,
                                       int y,
                                       const PixelCosts& pixel,
                                       Plane* best,
                                       float* best_cost) const {
    constexpr int kNumCandidates = kNumPropagationAreas + 1;
    Plane candidates[kNumCandidates] = {*best};
    int num_candidates = 1;
    for (int area = 0; area < kNumPropagationAreas; ++area) {
      const Plane plane = PlaneOfArea(x, y, area);
      if (IsUsable(plane, pixel.ray, options)) {
        candidates[num_candidates++] = plane;
      }
    }
    float weighted[kNumCandidates] = {};
    float plain[kNumCandidates] = {};
    int sum_weights = 0;
    for (int s = 0; s < num_sources; ++s) {
      float cost[kNumCandidates];
      ViewWeight view(iteration);
      for (int c = 0; c < num_candidates; ++c) {
        cost[c] = Photometric(pixel, s, candidates[c]);
        view.Add(cost[c]);
        cost[c] += pixel.Geometric(sources[s], candidates[c]);
      }
      const int weight = view.Get();
      sum_weights += weight;
      Weight(s, x, y) = static_cast<uint8_t>(weight);
      for (int c = 0; c < num_candidates; ++c) {
        weighted[c] += static_cast<float>(weight) * cost[c];
        plain[c] += cost[c];
      }
    }
    if (sum_weights == 0) {
      // No view stands out; all get the same weight.
      for (int s = 0; s < num_sources; ++s) {
        Weight(s, x, y) = 1;
      }
    }
    const float scale =
        1.f / static_cast<float>(sum_weights == 0 ? num_sources : sum_weights);
    for (int c = 0; c < num_candidates; ++c) {
      const float cost = scale * (sum_weights == 0 ? plain[c] : weighted[c]);
      if (c == 0 || cost < *best_cost) {
        *best_cost = cost;
        *best = candidates[c];
      }
    }
  }

  // The costs of a pixel by its selected views.
  struct WeightedCosts {
    const SweepKernel& sweep;
    const PixelCosts& pixel;
    int x;
    int y;
    float scale;  // 1 over the sum of the weights.

    // Takes the plane if it is better.
    TSAR_HD void Try(const Plane& plane, Plane* best, float* best_cost) const {
      if (!IsUsable(plane, pixel.ray, sweep.options)) {
        return;
      }
      // The sum is computed as in PropagateAndSelectViews: planes of equal
      // costs in every view, as without texture, must not win by rounding.
      float sum = 0.f;
      for (int s = 0; s < sweep.num_sources; ++s) {
        const int weight = sweep.Weight(s, x, y);
        if (weight > 0 && scale * sum < *best_cost) {
          sum += static_cast<float>(weight) *
                 (sweep.Photometric(pixel, s, plane) +
                  pixel.Geometric(sweep.sources[s], plane));
        }
      }
      const float cost = scale * sum;
      if (cost < *best_cost) {
        *best_cost = cost;
        *best = plane;
      }
    }
  };

  // Takes the best of the pixel's own plane, whose cost is known, and those of
  // its neighbors.
  TSAR_HD void Propagate(const WeightedCosts& weighted,
                         Plane* best,
                         float* best_cost) const {
    for (int area = 0; area < kNumPropagationAreas; ++area) {
      weighted.Try(PlaneOfArea(weighted.x, weighted.y, area), best, best_cost);
    }
  }

  // Takes the best of the plane, perturbed planes and random planes.
  TSAR_HD void Refine(const WeightedCosts& weighted,
                      Plane* best,
                      float* best_cost) const {
    const DepthBounds bounds{options.depth_min, options.depth_max};
    Philox random = PixelRandom(
        stream,
        static_cast<int64_t>(weighted.y) * planes.width + weighted.x,
        iteration + 1);
    const Vec3f& ray = weighted.pixel.ray;
    constexpr int kNumTrials = 6;
    for (int trial = 0; trial < kNumTrials; ++trial) {
      // Perturbations decrease with each trial and iteration.
      const int round = options.num_past_iterations + iteration;
      const float share =
          0.1f * PowerOfHalf(static_cast<float>(round) + 0.5f * trial);
      const float turn =
          0.5f * PowerOfHalf(0.5f * static_cast<float>(round) + 0.25f * trial);
      const float depth = best->Depth(ray);
      Plane plane;
      switch (trial) {
        case 0:
          plane = DrawPlane(bounds, ray, &random);
          break;
        case 1:
          plane = Plane::FromPoint(ray, depth, DrawNormal(ray, &random));
          break;
        case 2:
          plane = Plane::FromPoint(
              ray, bounds.DrawAround(depth, share, &random), best->normal);
          break;
        case 3:
          plane = Plane::FromPoint(
              ray, depth, DrawNormalAround(best->normal, turn, ray, &random));
          break;
        default: {
          const Vec3f normal =
              DrawNormalAround(best->normal, turn, ray, &random);
          plane = Plane::FromPoint(
              ray, bounds.DrawAround(depth, share, &random), normal);
        }
      }
      weighted.Try(plane, best, best_cost);
    }
  }
};

}  // namespace

DeviceImage<Plane> DrawPlanes(const Intrinsics& intrinsics,
                              int width,
                              int height,
                              uint32_t stream,
                              const PatchMatchOptions& options,
                              Device& device) {
  return MapPixels<Plane>(
      device,
      width,
      height,
      DrawKernel{
          intrinsics, {options.depth_min, options.depth_max}, stream, width});
}

PlaneHypotheses RunPatchMatch(const PatchMatchInputs& inputs,
                              DeviceImage<Plane> planes,
                              const PatchMatchOptions& options,
                              Device& device) {
  const int width = planes.Width();
  const int height = planes.Height();
  const int num_sources = inputs.sources.Size();
  if (num_sources > kMaxMatchedSources) {
    throw Error(ErrorCode::kBadOption,
                OptionName("num_sources") + ": give at most " +
                    std::to_string(kMaxMatchedSources));
  }
  PlaneHypotheses hypotheses{std::move(planes),
                             DeviceImage<float>(device, width, height)};
  const PlaneSearch search{inputs.reference,
                           inputs.sources.Data(),
                           num_sources,
                           options,
                           SourceTextures(inputs.sources)};
  ParallelFor(device,
              width,
              height,
              FirstCostKernel{
                  search, hypotheses.planes.View(), hypotheses.costs.View()});
  if (num_sources == 0) {
    return hypotheses;  // Without sources there are no costs.
  }
  Buffer<uint8_t> weights(device,
                          static_cast<size_t>(num_sources) *
                              static_cast<size_t>(width) *
                              static_cast<size_t>(height));
  for (int iteration = 0; iteration < options.num_iterations; ++iteration) {
    for (int color = 0; color < 2; ++color) {
      ParallelFor(device,
                  static_cast<int64_t>((width + 1) / 2) * height,
                  SweepKernel{search,
                              inputs.stream,
                              iteration,
                              iteration % kSelectionPeriod == 0,
                              color,
                              inputs.keeps_plane,
                              hypotheses.planes.View(),
                              hypotheses.costs.View(),
                              weights.Data()});
    }
  }
  return hypotheses;
}

}  // namespace tsar
