// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/discover_planes.h"

#include "tests/cuda/cuda_test.h"
#include "tests/planes/drawn_room.h"

namespace tsar {
namespace {

TEST_F(CudaTest, DiscoverPlanes) {
  const DrawnRoom room;
  const auto run = [&](Device& device) {
    const DiscoveredPlanes found =
        DiscoverPlanes(room.Views(), room.Candidates(), {}, device);
    std::vector<double> numbers;
    for (const ScenePlane& plane : found.planes) {
      numbers.insert(
          numbers.end(), plane.plane.normal.begin(), plane.plane.normal.end());
      numbers.push_back(plane.plane.offset);
      numbers.push_back(plane.support);
    }
    StageResult result;
    result.Add("planes", kSameLabels, numbers);
    for (const std::vector<int>& of_view : found.serving) {
      result.Add("serving", kSameLabels, of_view);
    }
    return result;
  };
  const StageResult on_cpu = run(*cpu_);
  EXPECT_EQ(on_cpu.Channels()[0].values.size(), 3u * 5u);
  EXPECT_EQ(FindDifferentBytes(on_cpu, run(*cuda_)), "");
}

}  // namespace
}  // namespace tsar
