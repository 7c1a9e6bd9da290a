// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/reduce_view.h"

#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/pipeline/square_hypothesis.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

int CeilOfQuotient(int a, int b) { return (a - 1) / b + 1; }

SquareHypothesis SquaresOf(const ViewData& view, int factor) {
  return {view.depth.View(),
          view.normal.View(),
          view.is_to_refine.View(),
          view.camera.GetIntrinsics(),
          factor};
}

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

}  // namespace

int ReductionFactor(int width, int height, int max_side) {
  return CeilOfQuotient(std::max(width, height), max_side);
}

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
  ViewData reduced;
  reduced.camera = ReduceCamera(view.camera, factor);
  reduced.num_not_finite = view.num_not_finite;
  const int width = reduced.camera.width;
  const int height = reduced.camera.height;
  reduced.color = MeanColors(view.color, factor, width, height);
  reduced.depth = Image<float>(width, height);
  reduced.normal = Image<Vec3f>(width, height);
  reduced.is_to_refine = Image<uint8_t>(width, height);
  const bool has_costs = !view.min_cost.Empty();
  if (has_costs) {
    reduced.min_cost = Image<float>(width, height, kUndefinedCost);
    reduced.second_cost = reduced.min_cost;
  }
  const SquareHypothesis squares = SquaresOf(view, factor);
  const Intrinsics intrinsics = reduced.camera.GetIntrinsics();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const ptrdiff_t found = squares.Find(x, y);
      if (found < 0) {
        continue;
      }
      const auto pixel = static_cast<size_t>(found);
      reduced.depth(x, y) = squares.DepthOnRay(
          found, intrinsics.Ray(static_cast<float>(x), static_cast<float>(y)));
      reduced.normal(x, y) = view.normal.Data()[pixel];
      const bool is_to_refine =
          view.is_to_refine.Empty() || view.is_to_refine.Data()[pixel] != 0;
      reduced.is_to_refine(x, y) = is_to_refine ? 1 : 0;
      reduced.num_depths_to_refine += is_to_refine ? 1 : 0;
      if (has_costs) {
        reduced.min_cost(x, y) = view.min_cost.Data()[pixel];
        reduced.second_cost(x, y) = view.second_cost.Data()[pixel];
      }
    }
  }
  return reduced;
}

bool HasReducedDepth(const ViewData& view, int factor) {
  const SquareHypothesis squares = SquaresOf(view, factor);
  for (int y = 0; y < CeilOfQuotient(view.depth.Height(), factor); ++y) {
    for (int x = 0; x < CeilOfQuotient(view.depth.Width(), factor); ++x) {
      if (squares.Find(x, y) >= 0) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace tsar
