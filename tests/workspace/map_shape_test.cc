// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/map_shape.h"

#include <algorithm>
#include <cmath>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr RasterSize kImage = {1244, 829};

TEST(MapShape, IsThatOfTheImageScaledAndRounded) {
  for (const RasterSize image :
       {kImage, {829, 1244}, {6208, 4135}, {96, 72}, {1000, 999}, {3000, 7}}) {
    for (int side = 1; side <= 2 * image.width; ++side) {
      const double scale = static_cast<double>(side) / image.width;
      for (const double height : {std::floor(scale * image.height),
                                  std::round(scale * image.height),
                                  std::ceil(scale * image.height)}) {
        const RasterSize map = {side, std::max(1, static_cast<int>(height))};
        ASSERT_TRUE(HasShapeOf(map, image))
            << ToString(map) << " of " << ToString(image);
      }
    }
  }
}

TEST(MapShape, IsNoOther) {
  for (const RasterSize map : {RasterSize{829, 1244},
                               {4000, 2},
                               {2, 4000},
                               {1244, 833},
                               {1240, 829},
                               {1244, 1},
                               {622, 420},
                               {414, 622}}) {
    EXPECT_FALSE(HasShapeOf(map, kImage)) << ToString(map);
  }
}

TEST(MapShape, TheErrorNamesFileAndSizes) {
  const auto require = [](const RasterSize& map) {
    RequireShape("maps/v0.bin", map, kImage, "the image v0.png", "map anew");
  };
  EXPECT_NO_THROW(require({622, 415}));
  ExpectError(ErrorCode::kMismatch,
              {"maps/v0.bin: has 829 x 1244 pixels, which is not the shape of "
               "the image v0.png of 1244 x 829; map anew"},
              [&] {
                require({829, 1244});
              });
}

}  // namespace
}  // namespace tsar
