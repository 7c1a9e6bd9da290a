// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_teams.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

struct CountVisits {
  ImageView<int> visits;
  void operator()(int x, int y) const { visits(x, y) += 1 + x + 100000 * y; }
};

class ParallelForTest : public testing::TestWithParam<int> {
 protected:
  ParallelForTest() : device_(Device::CreateCpu(GetParam())) {}
  std::unique_ptr<Device> device_;
};

TEST_P(ParallelForTest, VisitsEachPixelOnce) {
  const std::vector<std::pair<int, int>> sizes = {
      {1, 1}, {1, 97}, {97, 1}, {2, 3}, {31, 37}, {33, 5}, {64, 64}};
  for (const auto& [width, height] : sizes) {
    Image<int> visits(width, height, 0);
    ParallelFor(*device_, width, height, CountVisits{visits.View()});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(visits(x, y), 1 + x + 100000 * y);
      }
    }
  }
}

TEST_P(ParallelForTest, FillSetsTheFirstElements) {
  std::vector<float> values(101, 1.f);
  Fill(*device_, values.data(), 100, 2.5f);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(values[i], 2.5f);
  }
  EXPECT_EQ(values[100], 1.f);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelForTest, testing::Values(1, 2, 7));

// The sum of [0, count) and of their roots; each item has its own count.
struct SumKernel {
  const int* counts;
  int64_t* sums;
  double* roots;

  template <typename Team>
  void operator()(const Team& team, int64_t item) const {
    const int64_t sum = team.template Accumulate<int64_t>(
        counts[item], [](int i, int64_t* partial) { *partial += i; });
    const double root = team.template Accumulate<double>(
        counts[item], [](int i, double* partial) { *partial += std::sqrt(i); });
    if (team.IsLeader()) {
      sums[item] = sum;
      roots[item] = root;
    }
  }
};

template <int kSize>
void ExpectSums(int num_threads) {
  const auto device = Device::CreateCpu(num_threads);
  const std::vector<int> counts = {0, 1, 2, 31, 32, 33, 255, 256, 257, 10007};
  std::vector<int64_t> sums(counts.size(), -1);
  std::vector<double> roots(counts.size(), -1.0);
  ParallelForTeams<kSize>(*device,
                          static_cast<int64_t>(counts.size()),
                          SumKernel{counts.data(), sums.data(), roots.data()});
  for (size_t item = 0; item < counts.size(); ++item) {
    const int64_t n = counts[item];
    EXPECT_EQ(sums[item], n * (n - 1) / 2);
    double expected = 0.0;
    for (int i = 0; i < n; ++i) {
      expected += std::sqrt(i);
    }
    EXPECT_NEAR(roots[item], expected, 1e-12 * expected);
  }
}

TEST(ParallelForTeams, SumsWhateverTheSizeOfTheTeam) {
  for (const int num_threads : {1, 3}) {
    ExpectSums<32>(num_threads);
    ExpectSums<256>(num_threads);
  }
}

// A sum that depends on the order: lanes first, then halves onto halves.
struct OrderKernel {
  const float* values;
  int count;
  float* sum;

  template <typename Team>
  void operator()(const Team& team, int64_t /*item*/) const {
    *sum = team.template Accumulate<float>(
        count, [this](int i, float* partial) { *partial += values[i]; });
  }
};

TEST(ParallelForTeams, AddsInTheOrderThatTheHeaderStates) {
  const auto device = Device::CreateCpu(2);
  std::vector<float> values(1000);
  Philox random(1, 0, 0);
  for (float& value : values) {
    value = random.NextFloat() - 0.3f;
  }
  float sum = 0.f;
  ParallelForTeams<32>(*device, 1, OrderKernel{values.data(), 1000, &sum});
  float lanes[32] = {};
  for (int i = 0; i < 1000; ++i) {
    lanes[i % 32] += values[i];
  }
  for (int half = 16; half > 0; half /= 2) {
    for (int lane = 0; lane < half; ++lane) {
      lanes[lane] += lanes[lane + half];
    }
  }
  EXPECT_EQ(sum, lanes[0]);
}

}  // namespace
}  // namespace tsar
