// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/copy.h"

#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Copy, CopiesSoManyElementsAndNoMore) {
  const auto device = Device::CreateCpu(3);
  for (const size_t count : {0, 1, 13, 70001}) {
    std::vector<Vec3f> values(count);
    for (size_t i = 0; i < count; ++i) {
      values[i] = {static_cast<float>(i), 2.f, -static_cast<float>(i)};
    }
    const Vec3f untouched = {7.f, 8.f, 9.f};
    const Buffer<Vec3f> source(*device, values);
    Buffer<Vec3f> target(*device, std::vector<Vec3f>(count + 1, untouched));
    Copy(*device, source.Data(), count, target.Data());
    values.push_back(untouched);
    EXPECT_EQ(target.ToHost(), values);
  }
}

}  // namespace
}  // namespace tsar
