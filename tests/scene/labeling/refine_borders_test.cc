// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/refine_borders.h"

#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/filter/confirmation.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;
constexpr int kSuperpixelSize = 20;
constexpr int kNumColumns = kWidth / kSuperpixelSize;
constexpr int kNumSuperpixels = kNumColumns * kHeight / kSuperpixelSize;
constexpr int kWall = 0;
constexpr int kBox = 1;
constexpr float kWallDepth = 4.f;
constexpr float kBoxDepth = 3.f;

using Mask = std::function<bool(int x, int y)>;

// A camera looks at a wall and, in front of it, at a box whose superpixels are
// those that start left of column 40.
class RefineBordersTest : public testing::Test {
 protected:
  RefineBordersTest() {
    for (int s = 0; s < kNumSuperpixels; ++s) {
      labels_.push_back(s % kNumColumns < 2 ? kBox : kWall);
    }
  }

  template <typename Function>
  static void ForPixels(const Mask& where, const Function& function) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (where(x, y)) {
          function(x, y);
        }
      }
    }
  }

  void Paint(const Mask& is_bright) {
    lab_ = Image<Vec3f>(kWidth, kHeight, {40.f, 0.f, 0.f});
    ForPixels(is_bright, [&](int x, int y) { lab_(x, y).x = 80.f; });
  }

  // Texture that hides no edge.
  void Roughen(const Mask& is_textured) {
    ForPixels(is_textured, [&](int x, int y) {
      lab_(x, y).x += (x + y) % 2 == 0 ? 6.f : -6.f;
    });
  }

  void Measure(float depth, const Mask& where) {
    ForPixels(where, [&](int x, int y) {
      depth_(x, y) = depth;
      ratings_(x, y) = 255;
    });
  }

  struct Refined {
    Image<uint16_t> superpixels;
    Image<uint8_t> fattened;
  };

  Refined Refine() const {
    const DeviceImage<uint16_t> superpixels(*device_, superpixels_);
    const DeviceImage<Vec3f> lab(*device_, lab_);
    const DeviceImage<float> depth(*device_, depth_);
    const DeviceImage<uint8_t> flags(*device_, ratings_);
    const RefinedBorders refined = RefineBorders({superpixels.View(),
                                                  lab.View(),
                                                  depth.View(),
                                                  flags.View(),
                                                  {80.f, 80.f, 39.5f, 29.5f},
                                                  resolution_},
                                                 labels_,
                                                 planes_,
                                                 options_,
                                                 *device_);
    return {refined.superpixels.ToHost(), refined.fattened.ToHost()};
  }

  // Of a pixel after refinement.
  int Label(const Refined& refined, int x, int y) const {
    return labels_[refined.superpixels(x, y)];
  }

  // Pixels whose label is not kBox where is_box says so and `other` elsewhere.
  int CountWrong(const Mask& is_box, int other = kWall) const {
    const Refined refined = Refine();
    int num_wrong = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        num_wrong += Label(refined, x, y) != (is_box(x, y) ? kBox : other);
      }
    }
    return num_wrong;
  }

  void ExpectUnchanged() const {
    const Refined refined = Refine();
    EXPECT_TRUE(std::equal(
        superpixels_.begin(), superpixels_.end(), refined.superpixels.begin()));
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(2);
  Image<uint16_t> superpixels_ =
      SquareSuperpixels<uint16_t>(kWidth, kHeight, kSuperpixelSize);
  Image<Vec3f> lab_{kWidth, kHeight, {40.f, 0.f, 0.f}};
  Image<float> depth_{kWidth, kHeight};
  Image<uint8_t> ratings_{kWidth, kHeight};
  std::vector<int> labels_;
  std::vector<Plane> planes_ = {{{0.f, 0.f, -1.f}, kWallDepth},
                                {{0.f, 0.f, -1.f}, kBoxDepth}};
  DepthResolution resolution_{0.0025f};  // A pixel is 1 % of the wall's depth.
  BorderOptions options_;
};

TEST_F(RefineBordersTest, BorderMovesToTheEdgeOfTheImage) {
  for (const int edge : {33, 36, 39, 40, 41, 44, 47}) {
    const Mask is_box = [&](int x, int) { return x < edge; };
    Paint(is_box);
    EXPECT_EQ(CountWrong(is_box), 0) << "edge at " << edge;
  }
}

TEST_F(RefineBordersTest, BorderStaysWithoutAnEdge) { ExpectUnchanged(); }

TEST_F(RefineBordersTest, PixelsOutOfReachStay) {
  Paint([](int x, int) { return x < 60; });
  const Refined refined = Refine();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x < 40 - options_.reach || x >= 40 + options_.reach) {
        EXPECT_EQ(refined.superpixels(x, y), superpixels_(x, y));
      }
    }
  }
}

TEST_F(RefineBordersTest, CoincidingPlanesKeepTheirPixels) {
  Paint([](int x, int) { return x < 36; });
  planes_[kBox].offset = 0.992f * kWallDepth;
  ExpectUnchanged();
  planes_[kBox].offset = 0.98f * kWallDepth;
  EXPECT_EQ(CountWrong([](int x, int) { return x < 36; }), 0);
}

TEST_F(RefineBordersTest, PlanesBehindTheCameraGainNothing) {
  Paint([](int x, int) { return x < 44; });
  planes_[kBox].normal = {0.f, 0.f, 1.f};
  ExpectUnchanged();
}

// Its superpixels are as wide as it, but stand beside it.
TEST_F(RefineBordersTest, ThinObjectIsKept) {
  std::fill(labels_.begin(), labels_.end(), kWall);
  const int num_superpixels = kNumSuperpixels + 1;
  labels_.push_back(kBox);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 38; x < 42; ++x) {
      superpixels_(x, y) = num_superpixels - 1;
    }
  }
  const Mask is_post = [](int x, int) { return x >= 39 && x < 43; };
  Paint(is_post);
  EXPECT_EQ(CountWrong(is_post), 0);
}

TEST_F(RefineBordersTest, HolesGrowAndShrinkOnlyWhereTheyAre) {
  for (int& label : labels_) {
    label = label == kWall ? -1 : label;
  }
  for (const int edge : {36, 44}) {
    const Mask is_box = [&](int x, int) { return x < edge; };
    Paint(is_box);
    EXPECT_EQ(CountWrong(is_box, -1), 0);
  }
}

// With colors that say nothing, textured measurements decide, half of the way.
TEST_F(RefineBordersTest, TexturedMeasurementsMoveTheBorder) {
  const auto is_box = [](int x, int) { return x < 34; };
  Roughen([](int, int) { return true; });
  Measure(kBoxDepth, is_box);
  Measure(kWallDepth, std::not_fn(is_box));
  const Refined refined = Refine();
  for (int y = 10; y < kHeight - 10; ++y) {
    EXPECT_EQ(Label(refined, 33, y), kBox);
    EXPECT_EQ(Label(refined, 38, y), kWall);
  }
}

TEST_F(RefineBordersTest, DepthsFattenedOverAnEdgeAreFound) {
  const auto is_box = [](int x, int) { return x < 40; };
  Paint(is_box);
  Roughen(is_box);
  Measure(kBoxDepth, [](int x, int) { return x < 46; });
  EXPECT_EQ(CountWrong(is_box), 0);
  const Refined refined = Refine();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_EQ(refined.fattened(x, y), x >= 40 && x < 46) << x << ", " << y;
    }
  }
}

TEST_F(RefineBordersTest, TexturedObjectsOffAllPlanesAreNotFattened) {
  const auto is_object = [](int x, int y) {
    return x >= 60 && x < 70 && y >= 20 && y < 40;
  };
  Paint(is_object);
  Roughen(is_object);
  Measure(3.5f, is_object);
  const Refined refined = Refine();
  EXPECT_EQ(std::count(refined.fattened.begin(), refined.fattened.end(), 1), 0);
}

// What other views confirm stays known.
TEST_F(RefineBordersTest, DistrustFattenedCoversTheMap) {
  const uint8_t before = MeasurementFlags::Pack(true, Confirmation::kDistinct);
  Image<uint8_t> fattened(4, 3);
  fattened(1, 2) = 1;
  DeviceImage<uint8_t> flags(*device_, Image<uint8_t>(8, 6, before));
  DistrustFattened(
      DeviceImage<uint8_t>(*device_, fattened).View(), flags.View(), *device_);
  const Image<uint8_t> after = flags.ToHost();
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(after(x, y),
                x / 2 == 1 && y / 2 == 2
                    ? MeasurementFlags::WithoutTrust(before)
                    : before);
    }
  }
}

TEST_F(RefineBordersTest, TakesAMapLargerThanTheRaster) {
  const auto is_box = [](int x, int) { return x < 44; };
  Paint(is_box);
  depth_ = Image<float>(2 * kWidth, 2 * kHeight, kWallDepth);
  ratings_ = Image<uint8_t>(2 * kWidth, 2 * kHeight);
  EXPECT_EQ(CountWrong(is_box), 0);
}

}  // namespace
}  // namespace tsar
