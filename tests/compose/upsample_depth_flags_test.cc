// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/upsample_depth_flags.h"

#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/reduce_view.h"

#include <cstdint>
#include <memory>

#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kFactor = 3;
// u(z) is at its lower bound, so that the tolerance is 0.3 %.
const DepthResolution kFine = {1e-6f};

class UpsampleDepthFlagsTest : public testing::Test {
 protected:
  UpsampleDepthFlagsTest() {
    SyntheticViewsOptions options;
    options.width = 31;
    options.height = 24;
    options.has_bare_part = false;
    options.noise = 0.f;
    const SyntheticViews drawn = MakeSyntheticViews(options);
    view_ = drawn.views[0];
    Reduce();
    // A number for each block.
    ratings_ = Image<uint8_t>(reduced_.depth.Width(), reduced_.depth.Height());
    ForEachPixel(ratings_.Width(), ratings_.Height(), [&](int x, int y) {
      ratings_(x, y) = FlagsOf(x, y);
    });
  }

  static uint8_t FlagsOf(int x, int y) {
    return static_cast<uint8_t>(1 + 11 * y + x);
  }
  void Reduce() { reduced_ = ReduceView(view_, kFactor); }

  Image<uint8_t> Transfer(const DepthResolution& resolution = kFine) {
    ViewEvidence evidence;
    evidence.resolution = resolution;
    evidence.flags = ratings_;
    return UpsampleDepthFlags(
               evidence, DeviceReference(view_, *device_), *device_)
        .ToHost();
  }

  const std::unique_ptr<Device> device_ = CreateTestDevice(2);
  ViewData view_;
  ViewData reduced_;
  Image<uint8_t> ratings_;
};

TEST_F(UpsampleDepthFlagsTest, PixelsOfAPlaneTakeTheirBlocksFlags) {
  const Image<uint8_t> transferred = Transfer();
  ASSERT_TRUE(transferred.HasSizeOf(view_.depth));
  ForEachPixel(transferred.Width(), transferred.Height(), [&](int x, int y) {
    ASSERT_EQ(transferred(x, y), FlagsOf(x / kFactor, y / kFactor))
        << x << ", " << y;
  });
}

TEST_F(UpsampleDepthFlagsTest,
       PixelsOfABlockAcrossAnEdgeTakeTheirNeighborsFlags) {
  // A nearer surface covers the right third of block column 4 and everything to
  // its right: no depth represents the blocks of column 4.
  ForEachPixel(
      14, view_.depth.Width(), 0, view_.depth.Height(), [&](int x, int y) {
        view_.depth(x, y) *= 0.8f;
      });
  Reduce();
  ASSERT_EQ(reduced_.depth(4, 3), 0.f);
  const Image<uint8_t> transferred = Transfer();
  // The nearest in the adjacent column is the one in the same row.
  for (const int y : {9, 10, 11}) {
    EXPECT_EQ(transferred(12, y), FlagsOf(3, 3));
    EXPECT_EQ(transferred(13, y), FlagsOf(3, 3));
    EXPECT_EQ(transferred(14, y), FlagsOf(5, 3));
    EXPECT_EQ(transferred(15, y), FlagsOf(5, 3));
  }
}

TEST_F(UpsampleDepthFlagsTest, OtherDepthsGetNone) {
  view_.depth(10, 10) *= 1.05f;
  view_.depth(20, 10) = 0.f;
  Reduce();
  const Image<uint8_t> transferred = Transfer();
  EXPECT_EQ(transferred(10, 10), 0);
  EXPECT_EQ(transferred(20, 10), 0);
  EXPECT_EQ(transferred(11, 10), FlagsOf(3, 3));
}

TEST_F(UpsampleDepthFlagsTest, TheToleranceIsHalfOfWhatMatchingCanTell) {
  const Image<float> depth = view_.depth;
  view_.depth(10, 10) *= 1.0025f;
  EXPECT_EQ(Transfer()(10, 10), FlagsOf(3, 3));
  view_.depth = depth;
  view_.depth(13, 10) *= 1.0035f;
  EXPECT_EQ(Transfer()(13, 10), 0);
  // u(z) is 0.008 or more, so the tolerance is half of that.
  EXPECT_EQ(Transfer({0.01f / view_.depth(13, 10)})(13, 10), FlagsOf(4, 3));
}

TEST_F(UpsampleDepthFlagsTest, TheTrustOfAWholeMapStaysAsItIs) {
  const DeviceReference reference(view_, *device_);
  ViewEvidence evidence;
  evidence.flags = Image<uint8_t>(31, 24);
  for (size_t i = 0; i < evidence.flags.NumPixels(); ++i) {
    evidence.flags.Data()[i] = static_cast<uint8_t>(i % 256);
  }
  view_.depth(3, 3) = 0.f;
  const Image<uint8_t> transferred =
      UpsampleDepthFlags(evidence, reference, *device_).ToHost();
  EXPECT_TRUE(SameBytes(transferred, evidence.flags));
}

TEST_F(UpsampleDepthFlagsTest, RefusesTheTrustOfAnotherMap) {
  const DeviceReference reference(view_, *device_);
  ViewEvidence evidence;
  evidence.flags = Image<uint8_t>(12, 8);
  ExpectError(ErrorCode::kMismatch, {"12x8", "31x24", "run again"}, [&] {
    UpsampleDepthFlags(evidence, reference, *device_);
  });
}

// Trusted in the first row only; columns are in turn unconfirmed, weakly and
// distinctly confirmed.
TEST(PackFlags, KeepTrustAndConfirmation) {
  constexpr int kCount = 6;
  Image<uint8_t> trusted(kCount, 2);
  Image<uint8_t> confirmations(kCount, 2);
  for (int x = 0; x < kCount; ++x) {
    confirmations(x, 0) = confirmations(x, 1) = static_cast<uint8_t>(x % 3);
    trusted(x, 0) = 1;
  }
  const std::unique_ptr<Device> device = CreateTestDevice(1);
  DeviceCopies on_device(*device);
  const auto pack = [&](ImageView<const uint8_t> votes) {
    return PackFlags(on_device(trusted), votes, *device).ToHost();
  };
  const Image<uint8_t> flags = pack(on_device(confirmations));
  for (int x = 0; x < kCount; ++x) {
    for (int y = 0; y < 2; ++y) {
      const uint8_t packed = flags(x, y);
      EXPECT_EQ(MeasurementFlags::IsTrusted(packed), y == 0) << x;
      EXPECT_EQ(MeasurementFlags::IsConfirmed(packed), x % 3 > 0) << x;
      EXPECT_EQ(MeasurementFlags::IsConfirmedDistinctly(packed), x % 3 == 2)
          << x;
    }
  }
  for (const uint8_t flags : pack({})) {
    EXPECT_FALSE(MeasurementFlags::IsConfirmed(flags));
    EXPECT_FALSE(MeasurementFlags::IsConfirmedDistinctly(flags));
  }
}

}  // namespace
}  // namespace tsar
