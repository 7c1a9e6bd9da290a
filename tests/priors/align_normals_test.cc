// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/align_normals.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/priors/prior_likelihood.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 4;  // The side of a superpixel.
constexpr int kNumColumns = 20;
constexpr int kNumSuperpixels = kNumColumns * kNumColumns;

// Square superpixels on planes in three directions, of which every second one
// was measured.
class AlignNormalsTest : public testing::Test {
 protected:
  AlignNormalsTest()
      : superpixels_(kNumColumns * kSize, kNumColumns * kSize),
        samples_(superpixels_.Width(), superpixels_.Height(), {0.f, 0.f, 2.f}),
        normals_(superpixels_.Width(), superpixels_.Height()) {
    for (int y = 0; y < superpixels_.Height(); ++y) {
      for (int x = 0; x < superpixels_.Width(); ++x) {
        superpixels_(x, y) = y / kSize * kNumColumns + x / kSize;
      }
    }
    for (int k = 0; k < kNumSuperpixels; ++k) {
      if (k % 2 == 0) {
        planes_[k] = {Truth(k), 2.f};
      }
    }
  }

  static Vec3f Truth(int superpixel) {
    const Vec3f directions[] = {
        {0.f, 0.f, -1.f}, {0.8f, 0.f, -0.6f}, {0.f, -0.8f, -0.6f}};
    return directions[superpixel / 2 % 3];
  }
  // All normals of a superpixel deviate alike.
  void Draw(float sigma, float outlier_share) {
    Philox random(1, 2, 3);
    std::vector<Vec3f> drawn;
    for (int k = 0; k < kNumSuperpixels; ++k) {
      Vec3f normal = Truth(k);
      const Vec3f across = Normalized(Cross(normal, {1.f, 2.f, 0.5f}));
      const Vec3f along = Cross(normal, across);
      const bool is_outlier = random.NextFloat() < outlier_share;
      normal = is_outlier ? across
                          : normal + across * (sigma * Normal(&random)) +
                                along * (sigma * Normal(&random));
      drawn.push_back(Normalized(normal));
    }
    for (int y = 0; y < normals_.Height(); ++y) {
      for (int x = 0; x < normals_.Width(); ++x) {
        normals_(x, y) = drawn[superpixels_(x, y)];
      }
    }
  }
  // The sum of twelve uniform numbers is nearly normal.
  static float Normal(Philox* random) {
    float sum = -6.f;
    for (int i = 0; i < 12; ++i) {
      sum += random->NextFloat();
    }
    return sum;
  }
  AlignedPrior Align() const {
    AlignedPrior aligned;
    AlignNormals(normals_, superpixels_, planes_, samples_, &aligned);
    return aligned;
  }
  void ExpectDropped(PriorVerdict verdict) const {
    const AlignedPrior aligned = Align();
    EXPECT_EQ(aligned.assessment.of_normals, verdict);
    EXPECT_TRUE(aligned.normals.empty());
  }

  Image<int> superpixels_;
  Image<RayDepth> samples_;
  Image<Vec3f> normals_;
  std::vector<Plane> planes_ = std::vector<Plane>(kNumSuperpixels);
};

TEST_F(AlignNormalsTest, MeasuresTheirErrors) {
  Draw(0.1f, 0.15f);
  const AlignedPrior aligned = Align();
  EXPECT_EQ(aligned.assessment.of_normals, PriorVerdict::kUsed);
  EXPECT_NEAR(aligned.assessment.normal_sigma, 0.115f, 0.02f);
  EXPECT_NEAR(aligned.normal_outlier_share, 0.15f, 0.05f);
  ASSERT_EQ(aligned.normals.size(), size_t{kNumSuperpixels});
  EXPECT_LT(Norm(aligned.normals[1] - normals_(kSize, 0)), 1e-5f);
  EXPECT_EQ(Describe(aligned.assessment),
            "normals used: they deviate by 7 degrees from those of measured "
            "planes");
}

TEST_F(AlignNormalsTest, ExactNormalsAreNotCertain) {
  Draw(0.f, 0.f);
  EXPECT_EQ(Align().assessment.of_normals, PriorVerdict::kUsed);
  EXPECT_FLOAT_EQ(Align().assessment.normal_sigma, 0.01f);
}

TEST_F(AlignNormalsTest, SizesMayDiffer) {
  Draw(0.05f, 0.f);
  const float sigma = Align().assessment.normal_sigma;
  Image<Vec3f> twice(2 * normals_.Width(), 2 * normals_.Height());
  for (int y = 0; y < twice.Height(); ++y) {
    for (int x = 0; x < twice.Width(); ++x) {
      twice(x, y) = normals_(x / 2, y / 2);
    }
  }
  normals_ = twice;
  EXPECT_EQ(Align().assessment.normal_sigma, sigma);
}

TEST_F(AlignNormalsTest, NormalsThatDoNotAgreeAreUncertain) {
  Draw(0.05f, 0.f);
  for (int x = 0; x < kSize / 2; ++x) {
    for (int y = 0; y < kSize; ++y) {
      normals_(x, y) = {0.8f, 0.f, -0.6f};
    }
  }
  const AlignedPrior aligned = Align();
  const float sigma = aligned.assessment.normal_sigma;
  // Two directions at 53 degrees: each deviates by 0.46 from their mean.
  EXPECT_NEAR(NormalSigma(sigma, aligned.normals[0]), 0.46f, 0.03f);
  EXPECT_NEAR(NormalSigma(sigma, aligned.normals[1]), sigma, 1e-3f);
}

TEST_F(AlignNormalsTest, WrongNormalsAreDropped) {
  Draw(0.f, 1.f);
  ExpectDropped(PriorVerdict::kUnlike);
  normals_ = Image<Vec3f>(8, 6, {0.f, 0.f, -1.f});
  ExpectDropped(PriorVerdict::kUnlike);
  Draw(0.1f, 0.f);
  for (Vec3f& normal : normals_) {
    normal.x = -normal.x;  // Mirrored.
    normal.y = -normal.y;
  }
  ExpectDropped(PriorVerdict::kUnlike);
}

TEST_F(AlignNormalsTest, PlanesOfFewSamplesAreNotComparedWith) {
  Draw(0.1f, 0.f);
  const float sigma = Align().assessment.normal_sigma;
  for (int k = 0; k < kNumSuperpixels; k += 4) {
    planes_[k].normal = {0.6f, 0.8f, 0.f};
    const int column = k % kNumColumns;
    const int row = k / kNumColumns;
    for (int i = 0; i < kSize * kSize / 2 + 1; ++i) {
      samples_(column * kSize + i % kSize, row * kSize + i / kSize) = {};
    }
  }
  EXPECT_NEAR(Align().assessment.normal_sigma, sigma, 0.02f);
}

}  // namespace
}  // namespace tsar
