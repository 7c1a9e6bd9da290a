// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/pack_ratings.h"

#include "colmap_tsar/filtering/confirmation.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// Trusted in the first row only; columns are not confirmed, weakly and
// distinctly by turns.
TEST(PackRatings, KeepTrustConfirmationAndScore) {
  const std::vector<float> scores = {-1.f, 0.f, 0.5f, 0.8f, 1.f, 1.25f};
  const int count = static_cast<int>(scores.size());
  Image<float> score(count, 2);
  Image<uint8_t> trusted(count, 2);
  Image<uint8_t> confirmations(count, 2);
  for (int x = 0; x < count; ++x) {
    score(x, 0) = score(x, 1) = scores[static_cast<size_t>(x)];
    confirmations(x, 0) = confirmations(x, 1) = static_cast<uint8_t>(x % 3);
    trusted(x, 0) = 1;
  }
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  const auto pack = [&](ImageView<const uint8_t> votes) {
    return PackRatings(std::as_const(trusted).View(),
                       std::as_const(score).View(),
                       votes,
                       *device)
        .ToHost();
  };
  const Image<uint8_t> ratings = pack(std::as_const(confirmations).View());
  for (int x = 0; x < count; ++x) {
    for (int y = 0; y < 2; ++y) {
      const uint8_t rating = ratings(x, y);
      EXPECT_EQ(MeasurementRating::IsTrusted(rating), y == 0) << x;
      EXPECT_EQ(MeasurementRating::IsConfirmed(rating), x % 3 > 0) << x;
      EXPECT_EQ(MeasurementRating::IsConfirmedDistinctly(rating), x % 3 == 2)
          << x;
      EXPECT_NEAR(MeasurementRating::Score(rating),
                  std::clamp(scores[static_cast<size_t>(x)], 0.f, 1.f),
                  0.5f / 31.f)
          << x;
      const uint8_t distrusted = MeasurementRating::WithoutTrust(rating);
      EXPECT_FALSE(MeasurementRating::IsTrusted(distrusted));
      EXPECT_EQ(MeasurementRating::IsConfirmed(distrusted), x % 3 > 0);
      EXPECT_EQ(MeasurementRating::IsConfirmedDistinctly(distrusted),
                x % 3 == 2);
      EXPECT_EQ(MeasurementRating::Score(distrusted),
                MeasurementRating::Score(rating));
    }
  }
  for (const uint8_t rating : pack({})) {
    EXPECT_FALSE(MeasurementRating::IsConfirmed(rating));
    EXPECT_FALSE(MeasurementRating::IsConfirmedDistinctly(rating));
  }
}

}  // namespace
}  // namespace tsar
