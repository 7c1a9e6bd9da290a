// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/foreground_fattening.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 60;
constexpr int kHeight = 24;
constexpr int kBorder = 30;  // The first column of the right superpixel.
constexpr int kRadius = 5;   // The radius of patches.
constexpr int kNear = 2;     // A pattern this near is the pixel's.

template <typename T>
Image<T> Draw(const std::function<T(int x, int y)>& value,
              int width = kWidth,
              int height = kHeight) {
  Image<T> image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) = value(x, y);
    }
  }
  return image;
}

Image<float> Contrast(const Image<float>& gray) {
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  return ComputeContrast(DeviceImage<float>(*device, gray).View(), *device)
      .ToHost();
}

// With a superpixel on the left and one on the right.
Image<float> FatteningWeight(const Image<float>& gray, int radius = kRadius) {
  return ComputeFatteningWeight(
      gray,
      Contrast(gray),
      Draw<int>(
          [](int x, int) { return x >= kBorder; }, gray.Width(), gray.Height()),
      2,
      radius);
}

float Checkerboard(int x, int y) { return (x + y) % 2 == 0 ? 50.f : 150.f; }

// A checkerboard beside a wall of one gray level.
Image<float> PictureOnAWall() {
  return Draw<float>(
      [](int x, int y) { return x >= kBorder ? Checkerboard(x, y) : 200.f; });
}

void ExpectOnes(const Image<float>& own) {
  EXPECT_EQ(std::count(own.begin(), own.end(), 1.f),
            static_cast<int>(own.NumPixels()));
}

TEST(ForegroundFatteningTest, IsOneWhereNothingVaries) {
  const Image<float> own =
      FatteningWeight(Image<float>(kWidth, kHeight, 77.7f));
  EXPECT_EQ(own.Width(), kWidth);
  EXPECT_EQ(own.Height(), kHeight);
  ExpectOnes(own);
}

TEST(ForegroundFatteningTest, IsLowOnAWallBesideAPicture) {
  const Image<float> own = FatteningWeight(PictureOnAWall());
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x >= kBorder || x < kBorder - kRadius) {
        EXPECT_EQ(own(x, y), 1.f) << x;
      } else if (x < kBorder - kNear) {
        // The patch contains the edge, but not near the pixel.
        EXPECT_EQ(own(x, y), 0.f) << x;
      } else {
        // That the edge is near the pixel makes up for little.
        EXPECT_GT(own(x, y), 0.f) << x;
        EXPECT_LT(own(x, y), 0.1f) << x;
      }
    }
  }
}

TEST(ForegroundFatteningTest, NoiseOfAWallIsItsOwnFurtherFromAPicture) {
  Image<float> gray = PictureOnAWall();
  Philox random(4, 0, 0);
  for (float& level : gray) {
    level += 2.f * random.NextFloat();
  }
  const Image<float> own = FatteningWeight(gray);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x >= kBorder || x < kBorder - kRadius) {
        // At least 9 numbers span more than half the range of 121.
        EXPECT_EQ(own(x, y), 1.f) << x;
      } else {
        EXPECT_LT(own(x, y), 0.15f) << x;
      }
    }
  }
}

TEST(ForegroundFatteningTest, SuperpixelsOfLikeTextureShareAnEdge) {
  // Both sides are flat, so the edge may belong to either.
  const Image<float> step = FatteningWeight(
      Draw<float>([](int x, int) { return x >= kBorder ? 50.f : 150.f; }));
  // The right side has less than twice the texture of the left one.
  const Image<float> textured = FatteningWeight(Draw<float>([](int x, int y) {
    return (x >= kBorder ? 0.9f : 0.5f) * Checkerboard(x, y);
  }));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int from_step = x < kBorder ? kBorder - x : x - kBorder + 1;
      EXPECT_EQ(step(x, y), from_step > kNear && from_step <= kRadius ? 0 : 1)
          << x;
      EXPECT_GT(textured(x, y), 0.9f) << x;
    }
  }
}

TEST(ForegroundFatteningTest, GrowsWithTheShareOfTheContrast) {
  // The edge is two fifths as strong near the pixel as at the patch's rim.
  const int middle = 10;
  const Image<float> gray = Draw<float>([](int x, int) {
    return x == middle + kNear ? 40.f : x == middle + kRadius ? 100.f : 0.f;
  });
  EXPECT_NEAR(FatteningWeight(gray)(middle, 12), 0.8f, 1e-6f);
}

TEST(ForegroundFatteningTest, GrowsWithTheTextureOfTheSuperpixel) {
  // Contrasts of 10 and 100 gray levels, each with one added for noise; all of
  // the patch's contrast is close to the border.
  const Image<float> gray = Draw<float>([](int x, int y) {
    return (x >= kBorder ? 1.f : 0.1f) * Checkerboard(x, y);
  });
  const Image<float> own = FatteningWeight(gray);
  EXPECT_NEAR(own(kBorder - 1, 12), 2.f * 2.f * 11.f / 101.f, 1e-5f);
  EXPECT_EQ(own(kBorder, 12), 1.f);
}

TEST(ForegroundFatteningTest, AThinLineBelongsToItsPixels) {
  // A line across either superpixel, and one along their border.
  for (const int column : {15, kBorder - 1, kBorder, 45}) {
    const Image<float> own = FatteningWeight(
        Draw<float>([&](int x, int) { return x == column ? 30.f : 180.f; }));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int distance = std::abs(x - column);
        EXPECT_EQ(own(x, y), distance > kNear && distance <= kRadius ? 0 : 1)
            << column << ", " << x;
      }
    }
  }
}

TEST(ForegroundFatteningTest, TakesImagesSmallerThanThePatch) {
  for (const int width : {1, 2, 7}) {
    ExpectOnes(FatteningWeight(Draw<float>(Checkerboard, width, 3)));
  }
  // An edge in one corner.
  const Image<float> own = FatteningWeight(Draw<float>(
      [](int x, int y) { return x == 3 && y == 0 ? 90.f : 20.f; }, 4, 3));
  EXPECT_EQ(own(3, 0), 1.f);
  EXPECT_EQ(own(1, 2), 1.f);
  EXPECT_EQ(own(0, 0), 0.f);
  EXPECT_TRUE(FatteningWeight(Image<float>()).Empty());
}

}  // namespace
}  // namespace tsar
