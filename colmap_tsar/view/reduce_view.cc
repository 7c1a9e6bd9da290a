// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/reduce_view.h"

#include "colmap_tsar/matching/matching_cost.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

int CeilOfQuotient(int a, int b) { return (a - 1) / b + 1; }

BlockDepth BlocksOf(const ViewData& rows,
                    const Camera& camera,
                    int factor,
                    int first_row) {
  return {rows.depth.View(),
          rows.normal.View(),
          camera.GetIntrinsics(),
          factor,
          first_row};
}

Image<Rgb> MeanColors(const Image<Rgb>& color,
                      int factor,
                      int width,
                      int height) {
  Image<Rgb> reduced = Image<Rgb>::Uninitialized(width, height);
  // Of the channels in a block's rows, which compilers vectorize.
  std::vector<uint32_t> sums(3 * static_cast<size_t>(color.Width()));
  for (int y = 0; y < height; ++y) {
    std::ranges::fill(sums, 0u);
    const int begin_y = y * factor;
    const int end_y = std::min(begin_y + factor, color.Height());
    for (int j = begin_y; j < end_y; ++j) {
      const uint8_t* row = &color(0, j).r;
      for (size_t i = 0; i < sums.size(); ++i) {
        sums[i] += row[i];
      }
    }
    for (int x = 0; x < width; ++x) {
      const int end_x = std::min((x + 1) * factor, color.Width());
      const auto count =
          static_cast<uint32_t>((end_x - x * factor) * (end_y - begin_y));
      const auto mean = [&](int channel) {
        uint32_t sum = count / 2;
        for (int i = x * factor; i < end_x; ++i) {
          sum += sums[3 * i + channel];
        }
        return static_cast<uint8_t>(sum / count);
      };
      reduced(x, y) = {mean(0), mean(1), mean(2)};
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

ViewReducer::ViewReducer(const Camera& camera, int factor, bool has_costs)
    : camera_(camera), factor_(factor) {
  reduced_.camera = ReduceCamera(camera, factor);
  const int width = reduced_.camera.width;
  const int height = reduced_.camera.height;
  reduced_.depth = Image<float>(width, height);
  reduced_.normal = Image<Vec3f>(width, height);
  if (has_costs) {
    reduced_.min_cost = Image<float>(width, height, kUndefinedCost);
  }
}

void ViewReducer::Add(const ViewData& rows) {
  const BlockDepth blocks = BlocksOf(rows, camera_, factor_, num_rows_);
  const int first_row = num_rows_ / factor_;
  const int num_blocks = CeilOfQuotient(rows.depth.Height(), factor_);
  for (int y = 0; y < num_blocks; ++y) {
    for (int x = 0; x < reduced_.depth.Width(); ++x) {
      const ptrdiff_t pixel = blocks.Find(x, y);
      if (pixel >= 0) {
        Set(rows, blocks, pixel, x, first_row + y);
      }
    }
  }
  num_rows_ += rows.depth.Height();
}

void ViewReducer::Set(const ViewData& rows,
                      const BlockDepth& blocks,
                      ptrdiff_t pixel,
                      int x,
                      int y) {
  const auto index = static_cast<size_t>(pixel);
  reduced_.depth(x, y) =
      blocks.DepthOnRay(pixel,
                        reduced_.camera.GetIntrinsics().Ray(
                            static_cast<float>(x), static_cast<float>(y)));
  reduced_.normal(x, y) = rows.normal.Data()[index];
  ++reduced_.num_depths;
  if (!reduced_.min_cost.Empty()) {
    reduced_.min_cost(x, y) = rows.min_cost.Data()[index];
  }
}

ViewData ViewReducer::Finish(const Image<Rgb>& color) {
  reduced_.color = MeanColors(
      color, factor_, reduced_.depth.Width(), reduced_.depth.Height());
  return std::move(reduced_);
}

ViewData ReduceView(const ViewData& view, int factor) {
  if (factor == 1) {
    return view;
  }
  ViewReducer reducer(view.camera, factor, !view.min_cost.Empty());
  reducer.Add(view);
  ViewData reduced = reducer.Finish(view.color);
  reduced.num_not_finite = view.num_not_finite;
  reduced.prior = view.prior;
  return reduced;
}

}  // namespace tsar
