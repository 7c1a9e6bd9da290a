// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/pack_ratings.h"

#include "colmap_tsar/filtering/confirmation.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

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
      EXPECT_EQ(MeasurementRating::IsSure(rating), y == 0 || x % 3 == 2) << x;
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
