// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/lift_rating.h"

#include "colmap_tsar/scene/evidence/measurement_rating.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/reduce_view.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "tests/support/synthetic_views.h"
#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kFactor = 3;
// u(z) is at its lower bound, so that 0.3 % is what counts.
const DepthResolution kFine = {1e-6f};

class LiftRatingTest : public testing::Test {
 protected:
  LiftRatingTest() {
    SyntheticViewsOptions options;
    options.width = 31;
    options.height = 24;
    options.has_bare_part = false;
    options.noise = 0.f;
    const SyntheticViews drawn = MakeSyntheticViews(options);
    view_ = drawn.views[0];
    Reduce();
    // A number for each square.
    ratings_ = Image<uint8_t>(reduced_.depth.Width(), reduced_.depth.Height());
    for (int y = 0; y < ratings_.Height(); ++y) {
      for (int x = 0; x < ratings_.Width(); ++x) {
        ratings_(x, y) = RatingOf(x, y);
      }
    }
  }

  static uint8_t RatingOf(int x, int y) {
    return static_cast<uint8_t>(1 + 11 * y + x);
  }
  void Reduce() { reduced_ = ReduceView(view_, kFactor); }

  Image<uint8_t> Lift(const DepthResolution& resolution = kFine) {
    const DeviceImage<uint8_t> ratings(*device_, ratings_);
    const DeviceImage<float> judged_depth(*device_, reduced_.depth);
    const DeviceImage<Vec3f> judged_normal(*device_, reduced_.normal);
    const DeviceImage<float> depth(*device_, view_.depth);
    return LiftRatings({ratings.View(),
                        {judged_depth.View(), judged_normal.View()},
                        reduced_.camera.GetIntrinsics(),
                        kFactor},
                       depth.View(),
                       view_.camera.GetIntrinsics(),
                       resolution,
                       *device_)
        .ToHost();
  }

  const std::unique_ptr<Device> device_ = Device::CreateCpu(2);
  ViewData view_;
  ViewData reduced_;
  Image<uint8_t> ratings_;
};

TEST_F(LiftRatingTest, PixelsOfAPlaneTakeTheirSquaresRating) {
  const Image<uint8_t> lifted = Lift();
  ASSERT_TRUE(lifted.HasSizeOf(view_.depth));
  for (int y = 0; y < lifted.Height(); ++y) {
    for (int x = 0; x < lifted.Width(); ++x) {
      ASSERT_EQ(lifted(x, y), RatingOf(x / kFactor, y / kFactor))
          << x << ", " << y;
    }
  }
}

TEST_F(LiftRatingTest, PixelsOfASquareAcrossAnEdgeTakeTheirNeighborsRatings) {
  // A nearer surface over the right third of column 4 of the squares and what
  // lies right of it: no depth stands for the squares of column 4.
  for (int y = 0; y < view_.depth.Height(); ++y) {
    for (int x = 14; x < view_.depth.Width(); ++x) {
      view_.depth(x, y) *= 0.8f;
    }
  }
  Reduce();
  ASSERT_EQ(reduced_.depth(4, 3), 0.f);
  const Image<uint8_t> lifted = Lift();
  // The nearest of the column beside is the one in the same row.
  for (const int y : {9, 10, 11}) {
    EXPECT_EQ(lifted(12, y), RatingOf(3, 3));
    EXPECT_EQ(lifted(13, y), RatingOf(3, 3));
    EXPECT_EQ(lifted(14, y), RatingOf(5, 3));
    EXPECT_EQ(lifted(15, y), RatingOf(5, 3));
  }
}

TEST_F(LiftRatingTest, OtherDepthsGetNone) {
  view_.depth(10, 10) *= 1.05f;
  view_.depth(20, 10) = 0.f;
  Reduce();
  const Image<uint8_t> lifted = Lift();
  EXPECT_EQ(lifted(10, 10), 0);
  EXPECT_EQ(lifted(20, 10), 0);
  EXPECT_EQ(lifted(11, 10), RatingOf(3, 3));
}

TEST_F(LiftRatingTest, TheToleranceIsHalfOfWhatMatchingCanTell) {
  view_.depth(10, 10) *= 1.0025f;
  view_.depth(13, 10) *= 1.0035f;
  Image<uint8_t> lifted = Lift();
  EXPECT_EQ(lifted(10, 10), RatingOf(3, 3));
  EXPECT_EQ(lifted(13, 10), 0);
  // u(z) = 0.008 and more: as precise as that.
  lifted = Lift({0.01f / view_.depth(13, 10)});
  EXPECT_EQ(lifted(13, 10), RatingOf(4, 3));
}

TEST_F(LiftRatingTest, ANormalThatFacesAwayTellsOfNoSlant) {
  for (Vec3f& normal : reduced_.normal) {
    normal = {0.f, 0.f, 1.f};
  }
  view_.depth(10, 10) = reduced_.depth(3, 3);
  view_.depth(13, 10) = 1.0035f * reduced_.depth(4, 3);
  const Image<uint8_t> lifted = Lift();
  EXPECT_EQ(lifted(10, 10), RatingOf(3, 3));
  EXPECT_NE(lifted(13, 10), RatingOf(4, 3));
}

TEST_F(LiftRatingTest, TheTrustOfAWholeMapStaysAsItIs) {
  const DeviceReference reference(view_, *device_);
  ViewEvidence evidence;
  evidence.ratings = Image<uint8_t>(31, 24);
  for (size_t i = 0; i < evidence.ratings.NumPixels(); ++i) {
    evidence.ratings.Data()[i] = static_cast<uint8_t>(i % 256);
  }
  view_.depth(3, 3) = 0.f;
  const Image<uint8_t> lifted =
      LiftRatings(evidence, view_, reference, *device_).ToHost();
  ASSERT_TRUE(lifted.HasSizeOf(evidence.ratings));
  for (size_t i = 0; i < lifted.NumPixels(); ++i) {
    ASSERT_EQ(lifted.Data()[i], evidence.ratings.Data()[i]);
  }
}

TEST_F(LiftRatingTest, TheTrustOfAReducedMapIsLifted) {
  const DeviceReference reference(view_, *device_);
  ViewEvidence evidence;
  evidence.resolution = kFine;
  evidence.ratings = ratings_;
  const Image<uint8_t> lifted =
      LiftRatings(evidence, view_, reference, *device_).ToHost();
  const Image<uint8_t> expected = Lift();
  for (size_t i = 0; i < lifted.NumPixels(); ++i) {
    ASSERT_EQ(lifted.Data()[i], expected.Data()[i]);
  }
}

TEST_F(LiftRatingTest, RefusesTheTrustOfAnotherMap) {
  const DeviceReference reference(view_, *device_);
  ViewEvidence evidence;
  evidence.ratings = Image<uint8_t>(12, 8);
  ExpectError(ErrorCode::kMismatch, {"12x8", "31x24", "run again"}, [&] {
    LiftRatings(evidence, view_, reference, *device_);
  });
}

// Trusted in the first row only; columns are not confirmed, weakly and
// distinctly by turns.
TEST(PackRatings, KeepTrustAndConfirmation) {
  constexpr int kCount = 6;
  Image<uint8_t> trusted(kCount, 2);
  Image<uint8_t> confirmations(kCount, 2);
  for (int x = 0; x < kCount; ++x) {
    confirmations(x, 0) = confirmations(x, 1) = static_cast<uint8_t>(x % 3);
    trusted(x, 0) = 1;
  }
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  const auto pack = [&](ImageView<const uint8_t> votes) {
    return PackRatings(std::as_const(trusted).View(), votes, *device).ToHost();
  };
  const Image<uint8_t> ratings = pack(std::as_const(confirmations).View());
  for (int x = 0; x < kCount; ++x) {
    for (int y = 0; y < 2; ++y) {
      const uint8_t rating = ratings(x, y);
      EXPECT_EQ(MeasurementRating::IsTrusted(rating), y == 0) << x;
      EXPECT_EQ(MeasurementRating::IsConfirmed(rating), x % 3 > 0) << x;
      EXPECT_EQ(MeasurementRating::IsConfirmedDistinctly(rating), x % 3 == 2)
          << x;
      const uint8_t distrusted = MeasurementRating::WithoutTrust(rating);
      EXPECT_FALSE(MeasurementRating::IsTrusted(distrusted));
      EXPECT_EQ(MeasurementRating::IsConfirmed(distrusted), x % 3 > 0);
      EXPECT_EQ(MeasurementRating::IsConfirmedDistinctly(distrusted),
                x % 3 == 2);
    }
  }
  for (const uint8_t rating : pack({})) {
    EXPECT_FALSE(MeasurementRating::IsConfirmed(rating));
    EXPECT_FALSE(MeasurementRating::IsConfirmedDistinctly(rating));
  }
}

}  // namespace
}  // namespace tsar
