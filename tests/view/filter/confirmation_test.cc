// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/confirmation.h"

#include <memory>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 16;
// A variance of 1 at every level.
constexpr NoiseCurve kNoise{1.f, 0.f};

// Bare in the left half; columns of +- `contrast` levels in the right one.
Image<float> HalfTextured(float contrast) {
  Image<float> gray(kSize, kSize, 100.f);
  ForEachPixel(kSize / 2, kSize, 0, kSize, [&](int x, int y) {
    gray(x, y) += x % 2 == 0 ? contrast : -contrast;
  });
  return gray;
}

Image<uint8_t> Confirm(const Image<float>& gray,
                       const Image<uint8_t>& agreement,
                       const NoiseCurve& noise = kNoise) {
  const std::unique_ptr<Device> device = CreateTestDevice(2);
  DeviceCopies on_device(*device);
  return ConfirmDepths(on_device(gray), on_device(agreement), noise, *device)
      .ToHost();
}

void Expect(const Image<uint8_t>& confirmations,
            int x,
            int y,
            Confirmation expected) {
  EXPECT_EQ(confirmations(x, y), static_cast<uint8_t>(expected))
      << x << ", " << y;
}

TEST(ConfirmDepths, NeedsAnotherViewAndTextureOfItsOwn) {
  Image<uint8_t> agreement(kSize, kSize, 2);
  agreement(12, 5) = 0;
  agreement(13, 5) = 1;
  const Image<uint8_t> found = Confirm(HalfTextured(4.f), agreement);
  Expect(found, 2, 5, Confirmation::kNone);
  // The texture begins three pixels beside it.
  Expect(found, 5, 5, Confirmation::kNone);
  // Two columns of texture are its own.
  Expect(found, 6, 5, Confirmation::kWeak);
  Expect(found, 12, 5, Confirmation::kNone);
  Expect(found, 13, 5, Confirmation::kWeak);
  // The window is cut by the border.
  Expect(found, 15, 0, Confirmation::kWeak);
}

TEST(ConfirmDepths, MeasuresTextureInUnitsOfTheNoise) {
  const Image<uint8_t> agreement(kSize, kSize, 3);
  const auto expect = [&](float contrast,
                          const NoiseCurve& noise,
                          Confirmation expected) {
    SCOPED_TRACE(contrast);
    Expect(Confirm(HalfTextured(contrast), agreement, noise), 12, 8, expected);
  };
  // Its variance is 1: that of the noise.
  expect(1.f, kNoise, Confirmation::kNone);
  expect(1.f, {0.25f, 0.f}, Confirmation::kWeak);
  // More light, more noise.
  expect(4.f, {0.f, 0.01f}, Confirmation::kWeak);
  expect(4.f, {0.f, 0.16f}, Confirmation::kNone);
  // Noise that could pass for distinct texture.
  expect(16.f, {0.f, 2.f}, Confirmation::kNone);
}

TEST(ConfirmDepths, TellsDistinctTextureFromWeak) {
  // Columns of +- c levels: three and two of the five have a variance of
  // 0.96 c^2.
  const Image<uint8_t> agreement(kSize, kSize, 1);
  Expect(Confirm(HalfTextured(8.1f), agreement), 12, 8, Confirmation::kWeak);
  Expect(
      Confirm(HalfTextured(8.2f), agreement), 12, 8, Confirmation::kDistinct);
  Expect(Confirm(HalfTextured(8.2f), Image<uint8_t>(kSize, kSize)),
         12,
         8,
         Confirmation::kNone);
}

}  // namespace
}  // namespace tsar
