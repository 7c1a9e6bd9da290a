// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/reduce_view.h"

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/matching/matching_cost.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// A square was measured if no more than one pixel in this many is without the
// depth that stands for it.
constexpr size_t kPixelsPerGap = 8;
// How far off the plane that stands for a square its depths may lie.
constexpr float kMaxResidual = 0.005f;
// Along a plane seen at a grazing angle, half a square can be far.
constexpr float kMaxDepthChange = 0.02f;

int CeilOfQuotient(int a, int b) { return (a - 1) / b + 1; }

Camera ReduceCamera(const Camera& camera, int factor) {
  Camera reduced = camera;
  reduced.width = CeilOfQuotient(camera.width, factor);
  reduced.height = CeilOfQuotient(camera.height, factor);
  const double middle = 0.5 * (factor - 1);
  reduced.fx /= factor;
  reduced.fy /= factor;
  reduced.cx = (camera.cx - middle) / factor;
  reduced.cy = (camera.cy - middle) / factor;
  return reduced;
}

// Where the plane of a hypothesis of this depth meets another ray.
float DepthOnRay(const Plane& plane, float depth, const Vec3f& ray) {
  const float on_ray = plane.Depth(ray);
  return on_ray > 0.f && std::abs(on_ray - depth) <= kMaxDepthChange * depth
             ? on_ray
             : depth;
}

// Finds the pixel whose hypothesis stands for a square.
class RepresentativeFinder {
 public:
  RepresentativeFinder(const ViewData& view, int factor)
      : depth_(view.depth.View()),
        normal_(view.normal.View()),
        intrinsics_(view.camera.GetIntrinsics()),
        is_to_refine_(view.is_to_refine.View()),
        factor_(factor) {
    // One more than there can be: each pixel is written to both lists.
    const size_t max_pixels =
        static_cast<size_t>(std::min(factor, depth_.width)) *
            static_cast<size_t>(std::min(factor, depth_.height)) +
        1;
    for (Candidates* candidates : {&own_, &other_}) {
      candidates->pixels.resize(max_pixels);
      candidates->depths.resize(max_pixels);
    }
  }

  // The pixel's place in the map, or -1 where there is none.
  ptrdiff_t Find(int x, int y) {
    const int begin_x = x * factor_;
    const int begin_y = y * factor_;
    const int end_x = std::min(begin_x + factor_, depth_.width);
    const int end_y = std::min(begin_y + factor_, depth_.height);
    own_.count = 0;
    other_.count = 0;
    for (int j = begin_y; j < end_y; ++j) {
      for (int i = begin_x; i < end_x; ++i) {
        const size_t pixel = depth_.Index(i, j);
        const float depth = depth_.data[pixel];
        const bool is_valid = depth > 0.f;
        // Without the raster, all are from the map to refine.
        const bool is_own =
            is_to_refine_.Empty() || is_to_refine_.data[pixel] != 0;
        own_.Put(pixel, depth, is_valid && is_own);
        other_.Put(pixel, depth, is_valid && !is_own);
      }
    }
    const size_t num_pixels = static_cast<size_t>(end_x - begin_x) *
                              static_cast<size_t>(end_y - begin_y);
    const size_t min_count = num_pixels - num_pixels / kPixelsPerGap;
    for (const Candidates* candidates : {&own_, &other_}) {
      if (candidates->count < min_count) {
        continue;
      }
      const size_t median = Median(*candidates);
      if (CountOnPlane(*candidates, median) >= min_count) {
        return static_cast<ptrdiff_t>(candidates->pixels[median]);
      }
    }
    return -1;
  }

 private:
  struct Candidates {
    // Without a branch, which would be hard to foresee.
    void Put(size_t pixel, float depth, bool counts) {
      pixels[count] = pixel;
      depths[count] = depth;
      count += counts ? 1 : 0;
    }

    std::vector<size_t> pixels;  // Row by row.
    std::vector<float> depths;
    size_t count = 0;
  };

  // The number of the first one with the median depth. Squares are so small
  // that counting for each pixel, without a branch, is faster than to sort.
  static size_t Median(const Candidates& candidates) {
    const size_t middle = (candidates.count - 1) / 2;
    size_t i = 0;
    for (; i + 1 < candidates.count; ++i) {
      uint32_t num_nearer = 0;
      uint32_t num_as_near = 0;
      for (size_t j = 0; j < candidates.count; ++j) {
        num_nearer += candidates.depths[j] < candidates.depths[i] ? 1 : 0;
        num_as_near += candidates.depths[j] == candidates.depths[i] ? 1 : 0;
      }
      if (num_nearer <= middle && middle < num_nearer + num_as_near) {
        break;
      }
    }
    return i;
  }

  // How many of the candidates lie on the plane of one of them.
  size_t CountOnPlane(const Candidates& candidates, size_t one) const {
    const float depth = candidates.depths[one];
    const size_t pixel = candidates.pixels[one];
    const Plane plane =
        Plane::FromPoint(RayOf(pixel), depth, normal_.data[pixel]);
    size_t count = 0;
    for (size_t i = 0; i < candidates.count; ++i) {
      const float expected =
          DepthOnRay(plane, depth, RayOf(candidates.pixels[i]));
      count += std::abs(candidates.depths[i] - expected) <= kMaxResidual * depth
                   ? 1
                   : 0;
    }
    return count;
  }

  Vec3f RayOf(size_t pixel) const {
    const auto width = static_cast<size_t>(depth_.width);
    return intrinsics_.Ray(static_cast<float>(pixel % width),
                           static_cast<float>(pixel / width));
  }

  const ImageView<const float> depth_;
  const ImageView<const Vec3f> normal_;
  const Intrinsics intrinsics_;
  const ImageView<const uint8_t> is_to_refine_;
  const int factor_;
  Candidates own_;
  Candidates other_;
};

Image<Rgb> MeanColors(const Image<Rgb>& color,
                      int factor,
                      int width,
                      int height) {
  struct Sum {
    uint32_t r = 0;
    uint32_t g = 0;
    uint32_t b = 0;
  };
  Image<Rgb> reduced = Image<Rgb>::Uninitialized(width, height);
  std::vector<Sum> sums(static_cast<size_t>(width));
  for (int y = 0; y < height; ++y) {
    std::fill(sums.begin(), sums.end(), Sum{});
    const int begin_y = y * factor;
    const int end_y = std::min(begin_y + factor, color.Height());
    for (int j = begin_y; j < end_y; ++j) {
      const Rgb* row = &color(0, j);
      for (int x = 0; x < width; ++x) {
        Sum sum = sums[static_cast<size_t>(x)];
        const int end_x = std::min((x + 1) * factor, color.Width());
        for (int i = x * factor; i < end_x; ++i) {
          sum.r += row[i].r;
          sum.g += row[i].g;
          sum.b += row[i].b;
        }
        sums[static_cast<size_t>(x)] = sum;
      }
    }
    for (int x = 0; x < width; ++x) {
      const int num_columns = std::min(factor, color.Width() - x * factor);
      const auto count = static_cast<uint32_t>(num_columns * (end_y - begin_y));
      const auto mean = [count](uint32_t sum) {
        return static_cast<uint8_t>((sum + count / 2) / count);
      };
      const Sum& sum = sums[static_cast<size_t>(x)];
      reduced(x, y) = {mean(sum.r), mean(sum.g), mean(sum.b)};
    }
  }
  return reduced;
}

// Calls visit(pixel, reduced pixel) with the places of representatives.
template <typename Function>
ViewData ReduceWith(const ViewData& view, int factor, Function visit) {
  ViewData reduced;
  reduced.camera = ReduceCamera(view.camera, factor);
  reduced.num_not_finite = view.num_not_finite;
  const int width = CeilOfQuotient(view.depth.Width(), factor);
  const int height = CeilOfQuotient(view.depth.Height(), factor);
  reduced.depth = Image<float>(width, height);
  reduced.normal = Image<Vec3f>(width, height);
  reduced.is_to_refine = Image<uint8_t>(width, height);
  const Intrinsics from = view.camera.GetIntrinsics();
  const Intrinsics to = reduced.camera.GetIntrinsics();
  RepresentativeFinder finder(view, factor);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const ptrdiff_t found = finder.Find(x, y);
      if (found < 0) {
        continue;
      }
      const auto pixel = static_cast<size_t>(found);
      const auto column = static_cast<int>(found % view.depth.Width());
      const auto row = static_cast<int>(found / view.depth.Width());
      const Vec3f& normal = view.normal.Data()[pixel];
      const float depth = view.depth.Data()[pixel];
      reduced.depth(x, y) =
          DepthOnRay(Plane::FromPoint(from.Ray(column, row), depth, normal),
                     depth,
                     to.Ray(x, y));
      reduced.normal(x, y) = normal;
      const bool is_to_refine =
          view.is_to_refine.Empty() || view.is_to_refine.Data()[pixel] != 0;
      reduced.is_to_refine(x, y) = is_to_refine ? 1 : 0;
      reduced.num_depths_to_refine += is_to_refine ? 1 : 0;
      visit(pixel, reduced.depth.View().Index(x, y));
    }
  }
  return reduced;
}

}  // namespace

int ReductionFactor(int width, int height, int max_side) {
  return CeilOfQuotient(std::max(width, height), max_side);
}

int FactorBetween(int width,
                  int height,
                  int reduced_width,
                  int reduced_height) {
  const int side = std::max(width, height);
  const int reduced_side = std::max(reduced_width, reduced_height);
  for (int factor = 1; CeilOfQuotient(side, factor) >= reduced_side; ++factor) {
    if (CeilOfQuotient(width, factor) == reduced_width &&
        CeilOfQuotient(height, factor) == reduced_height) {
      return factor;
    }
    if (factor == side) {
      break;
    }
  }
  return 0;
}

ViewData ReduceView(const ViewData& view, int factor) {
  if (factor == 1) {
    return view;
  }
  const int width = CeilOfQuotient(view.depth.Width(), factor);
  const int height = CeilOfQuotient(view.depth.Height(), factor);
  Image<float> min_cost;
  Image<float> second_cost;
  const bool has_costs = !view.min_cost.Empty();
  if (has_costs) {
    min_cost = Image<float>(width, height, kUndefinedCost);
    second_cost = min_cost;
  }
  ViewData reduced =
      ReduceWith(view, factor, [&](size_t pixel, size_t reduced_pixel) {
        if (has_costs) {
          min_cost.Data()[reduced_pixel] = view.min_cost.Data()[pixel];
          second_cost.Data()[reduced_pixel] = view.second_cost.Data()[pixel];
        }
      });
  reduced.min_cost = std::move(min_cost);
  reduced.second_cost = std::move(second_cost);
  reduced.color = MeanColors(view.color, factor, width, height);
  return reduced;
}

ViewData ReduceHypotheses(const ViewData& view, int factor) {
  return ReduceWith(view, factor, [](size_t, size_t) {});
}

bool HasReducedDepth(const ViewData& view, int factor) {
  RepresentativeFinder finder(view, factor);
  for (int y = 0; y < CeilOfQuotient(view.depth.Height(), factor); ++y) {
    for (int x = 0; x < CeilOfQuotient(view.depth.Width(), factor); ++x) {
      if (finder.Find(x, y) >= 0) {
        return true;
      }
    }
  }
  return false;
}

int64_t ReducedHypothesesBytes(int64_t num_pixels) {
  constexpr size_t kBytesPerPixel =
      sizeof(float) + sizeof(Vec3f) + sizeof(uint8_t);
  return num_pixels * static_cast<int64_t>(kBytesPerPixel);
}

}  // namespace tsar
