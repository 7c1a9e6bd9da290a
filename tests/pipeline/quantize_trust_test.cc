// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/quantize_trust.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(QuantizeTrust, IsTheScoreRoundedUpWhereADepthIsTrusted) {
  const std::vector<std::pair<float, int>> levels = {{-1.f, 1},
                                                     {0.f, 1},
                                                     {1e-6f, 1},
                                                     {0.5f, 128},
                                                     {0.8f, 204},
                                                     {0.999f, 255},
                                                     {1.f, 255},
                                                     {1.25f, 255}};
  const int count = static_cast<int>(levels.size());
  // Trusted in the first row only.
  Image<float> score(count, 2);
  Image<uint8_t> trusted(count, 2);
  for (int x = 0; x < count; ++x) {
    score(x, 0) = score(x, 1) = levels[static_cast<size_t>(x)].first;
    trusted(x, 0) = 1;
  }
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  const Image<uint8_t> trust =
      QuantizeTrust(
          std::as_const(trusted).View(), std::as_const(score).View(), *device)
          .ToHost();
  for (int x = 0; x < count; ++x) {
    EXPECT_EQ(trust(x, 0), levels[static_cast<size_t>(x)].second) << x;
    EXPECT_EQ(trust(x, 1), 0) << x;
  }
}

}  // namespace
}  // namespace tsar
