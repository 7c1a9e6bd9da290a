// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// What all stages are made of: loops, teams, sums and components. What they
// compute on the CPU is tested in tests/device; here main.cc compares all that
// they copy to the host.

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_teams.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/matching/sample_gray.cuh"

#include <algorithm>
#include <climits>
#include <utility>
#include <vector>

#include "tests/device/drawn_components.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Around the sizes of warps and blocks, and beyond 65,536 warps.
constexpr int kCounts[] = {
    0, 1, 31, 32, 33, 255, 256, 257, 10007, 65536 * 32 + 17};
constexpr std::pair<int, int> kRasters[] = {{0, 5},
                                            {5, 0},
                                            {1, 1},
                                            {1, 37},
                                            {37, 1},
                                            {31, 3},
                                            {33, 5},
                                            {1201, 37},
                                            {65539, 3},
                                            {3, 65539}};

class KernelsTest : public testing::Test {
 protected:
  // Calls compute(count, device), which copies its results to the host: twice,
  // because a race need not show at once.
  template <typename Compute>
  static void ForCounts(const Compute& compute) {
    for (const int count : kCounts) {
      for (int run = 0; run < 2; ++run) {
        compute(count, *CreateTestDevice());
      }
    }
  }
};

std::vector<float> DrawNumbers(int count) {
  Philox random(7, 0, 0);
  std::vector<float> numbers;
  for (int i = 0; i < count; ++i) {
    numbers.push_back(random.NextFloat());
  }
  return numbers;
}

// Shows which elements were visited, and that each was visited once.
struct VisitKernel {
  ImageView<int64_t> visits;
  TSAR_HD void operator()(int64_t i) const { visits.data[i] += i + 1; }
  TSAR_HD void operator()(int x, int y) const {
    visits(x, y) += 1 + x + (static_cast<int64_t>(y) << 32);
  }
};

TEST_F(KernelsTest, ParallelForVisitsEachIndexOnce) {
  ForCounts([](int count, Device& device) {
    Buffer<int64_t> visits(device, std::vector<int64_t>(count, 0));
    ParallelFor(device, int64_t{count}, VisitKernel{{visits.Data(), count, 1}});
    visits.ToHost();
  });
}

TEST_F(KernelsTest, ParallelForVisitsEachPixelOnce) {
  const auto device = CreateTestDevice();
  for (const auto& [width, height] : kRasters) {
    DeviceImage<int64_t> visits(*device, Image<int64_t>(width, height, 0));
    ParallelFor(*device, width, height, VisitKernel{visits.View()});
    visits.ToHost();
  }
}

TEST_F(KernelsTest, FillAndCopyWriteTheirElementsOnly) {
  ForCounts([](int count, Device& device) {
    const Buffer<float> source(device, DrawNumbers(count));
    Buffer<float> target(device, std::vector<float>(2 * count + 3, -1.f));
    Copy(device, source.Data(), source.Size(), target.Data() + 1);
    Fill(device, target.Data() + count + 2, source.Size(), 0.7f);
    target.ToHost();
  });
}

TEST_F(KernelsTest, ExclusiveSum) {
  ForCounts([](int count, Device& device) {
    std::vector<int> values;
    for (const float number : DrawNumbers(count)) {
      values.push_back(static_cast<int>(number * 1000.f) - 300);
    }
    const Buffer<int> buffer(device, values);
    ExclusiveSum(buffer.Data(), buffer.Size(), device).ToHost();
  });
}

constexpr int kNumSlots = 7;

// Many threads change few numbers.
struct SharedNumbersKernel {
  int* sums;
  int* minima;
  int64_t* long_sums;
  uint64_t* maxima;

  TSAR_HD void operator()(int64_t i) const {
    const int64_t slot = i % kNumSlots;
    const uint64_t mixed = static_cast<uint64_t>(i) * 0x9E3779B97F4A7C15u;
    AtomicAdd(sums + slot, static_cast<int>(mixed >> 57) - 50);
    AtomicMin(minima + slot, static_cast<int>(mixed >> 32));
    AtomicAdd(long_sums + slot,
              static_cast<int64_t>(mixed >> 20) - (int64_t{1} << 42));
    AtomicMax(maxima + slot, mixed);
  }
};

TEST_F(KernelsTest, AtomicsOnSharedNumbersLoseNothing) {
  ForCounts([](int count, Device& device) {
    Buffer<int> sums(device, std::vector<int>(kNumSlots, 0));
    Buffer<int> minima(device, std::vector<int>(kNumSlots, INT_MAX));
    Buffer<int64_t> long_sums(device, std::vector<int64_t>(kNumSlots, 0));
    Buffer<uint64_t> maxima(device, std::vector<uint64_t>(kNumSlots, 0));
    ParallelFor(
        device,
        int64_t{count},
        SharedNumbersKernel{
            sums.Data(), minima.Data(), long_sums.Data(), maxima.Data()});
    sums.ToHost();
    minima.ToHost();
    long_sums.ToHost();
    maxima.ToHost();
  });
}

// Each thread gets a number of its own from what AtomicAdd returns.
struct TicketKernel {
  int* next;
  int64_t* long_next;
  int* taken;
  uint8_t* long_taken;

  TSAR_HD void operator()(int64_t /*i*/) const {
    ++taken[AtomicAdd(next, 1)];
    AtomicStore(long_taken + (AtomicAdd(long_next, int64_t{1} << 33) >> 33), 1);
  }
};

TEST_F(KernelsTest, AtomicAddReturnsWhatWasThereBefore) {
  ForCounts([](int count, Device& device) {
    Buffer<int> next(device, std::vector<int>(1, 0));
    Buffer<int64_t> long_next(device, std::vector<int64_t>(1, 0));
    Buffer<int> taken(device, std::vector<int>(count, 0));
    Buffer<uint8_t> long_taken(device, std::vector<uint8_t>(count, 0));
    ParallelFor(
        device,
        int64_t{count},
        TicketKernel{
            next.Data(), long_next.Data(), taken.Data(), long_taken.Data()});
    taken.ToHost();
    long_taken.ToHost();
  });
}

// Each thread has numbers of its own.
struct OwnNumbersKernel {
  int* numbers;
  uint64_t* long_numbers;
  int* stored_for;  // What AtomicMin and then AtomicLoad return.

  TSAR_HD void operator()(int64_t i) const {
    const int offer = static_cast<int>(i % 201) - 100;
    stored_for[2 * i] = AtomicMin(numbers + i, offer);
    stored_for[2 * i + 1] = AtomicLoad(numbers + i);
    const uint64_t before = AtomicMax(long_numbers + i, UINT64_MAX - i % 3);
    AtomicMax(long_numbers + i, before + 1);
  }
};

TEST_F(KernelsTest, AtomicMinAndMaxReturnWhatWasThereBefore) {
  ForCounts([](int count, Device& device) {
    std::vector<int> values;
    std::vector<uint64_t> long_values;
    for (const float number : DrawNumbers(count)) {
      values.push_back(static_cast<int>(number * 300.f) - 150);
      long_values.push_back(UINT64_MAX - static_cast<uint64_t>(number * 5.f));
    }
    Buffer<int> numbers(device, values);
    Buffer<uint64_t> long_numbers(device, long_values);
    Buffer<int> returned(device, 2 * values.size());
    ParallelFor(
        device,
        int64_t{count},
        OwnNumbersKernel{numbers.Data(), long_numbers.Data(), returned.Data()});
    long_numbers.ToHost();
    numbers.ToHost();
    returned.ToHost();
  });
}

struct Moments {
  int count = 0;
  double sum = 0.0;
  float squares = 0.f;

  TSAR_HD Moments& operator+=(const Moments& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
    return *this;
  }
};

// Sums that, because of rounding, depend on the order of their terms; one needs
// the result of another.
struct TeamKernel {
  static constexpr int kNumSums = 5;
  const int* counts;
  const float* values;
  double* sums;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const int count = counts[item];
    const Moments first =
        team.template Accumulate<Moments>(count, [this](int i, Moments* sum) {
          *sum += {1, 1.0 / (1.0 + values[i]), values[i] * values[i]};
        });
    const double mean = first.count > 0 ? first.sum / first.count : 0.0;
    const Moments second = team.template Accumulate<Moments>(
        count, [this, mean](int i, Moments* sum) {
          *sum += {2, values[i] - mean, 0.1f * values[i]};
        });
    const int64_t indices = team.template Accumulate<int64_t>(
        count, [](int i, int64_t* sum) { *sum += i; });
    if (team.IsLeader()) {
      double* own = sums + kNumSums * item;
      own[0] = first.sum;
      own[1] = first.squares;
      own[2] = second.sum;
      own[3] = second.squares;
      own[4] = static_cast<double>(first.count + second.count + indices);
    }
  }
};

template <int kSize>
void SumByTeams(const std::vector<int>& counts, Device& device) {
  const Buffer<int> device_counts(device, counts);
  const Buffer<float> values(
      device, DrawNumbers(*std::max_element(counts.begin(), counts.end())));
  Buffer<double> sums(
      device, std::vector<double>(TeamKernel::kNumSums * counts.size(), -1.0));
  ParallelForTeams<kSize>(
      device,
      static_cast<int64_t>(counts.size()),
      TeamKernel{device_counts.Data(), values.Data(), sums.Data()});
  sums.ToHost();
}

TEST_F(KernelsTest, TeamsAddInTheSameOrder) {
  const std::vector<int> counts(std::begin(kCounts), std::end(kCounts));
  std::vector<int> many;
  for (int item = 0; item < 65536 + 17; ++item) {
    many.push_back(item % 41);
  }
  const auto device = CreateTestDevice();
  for (const std::vector<int>& each : {counts, many}) {
    for (int run = 0; run < 2; ++run) {
      SumByTeams<32>(each, *device);
      SumByTeams<256>(each, *device);
    }
  }
}

// Copies the labels and the sizes of the components to the host.
void LabelAndCount(const Image<int>& host) {
  const auto device = CreateTestDevice();
  const DeviceImage<int> values(*device, host);
  for (const Connectivity connectivity :
       {Connectivity::kFour, Connectivity::kEight}) {
    for (int run = 0; run < 2; ++run) {
      DeviceImage<int> labels(*device, host.Width(), host.Height());
      LabelComponents(*device,
                      SimilarValue{values.View().data},
                      connectivity,
                      labels.View());
      Buffer<int> sizes(*device, std::vector<int>(host.NumPixels(), 0));
      CountComponentPixels(*device, labels.View(), sizes.Data());
      labels.ToHost();
      sizes.ToHost();
    }
  }
}

TEST(ComponentsTest, OfRastersOfAnySize) {
  uint32_t seed = 0;
  for (const auto& [width, height] : kRasters) {
    for (const int num_values : {2, 3, 5, 8}) {
      LabelAndCount(DrawNoise(width, height, num_values, ++seed));
    }
    LabelAndCount(Image<int>(width, height, 3));
    LabelAndCount(Image<int>(width, height, -1));
  }
}

TEST(ComponentsTest, ThatWindThroughTheRaster) {
  for (const bool along_rows : {false, true}) {
    LabelAndCount(DrawSnake(257, 131, along_rows));
    LabelAndCount(DrawSnake(65539, 5, along_rows));
    LabelAndCount(DrawSnake(5, 65539, along_rows));
  }
  LabelAndCount(DrawSpiral(301, 207));
}

struct SampleKernel {
  GrayView image;
  const float* x;
  const float* y;
  float* values;
  TSAR_HD void operator()(int64_t i) const {
    values[i] = SampleGray(image, x[i], y[i]);
  }
};

// Texture units are emulated on the CPU: all their weights must be known.
TEST_F(KernelsTest, TexturesInterpolateAsOnTheCpu) {
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 9}, {9, 1}, {2, 2}, {3, 3}, {641, 37}}) {
    const auto device = CreateTestDevice();
    Image<float> gray(width, height);
    Philox random(7, 0, 0);
    for (float& value : gray) {
      value = 255.f * random.NextFloat();
    }
    const DeviceImage<float> on_device(*device, gray);
    const GrayTexture texture = ComputeGrayTexture(on_device.View(), *device);
    std::vector<float> x;
    std::vector<float> y;
    // All weights, positions between the steps of 1/256, and any others.
    constexpr int kNumSteps = 3 * 256;
    for (int i = 0; i < kNumSteps * kNumSteps; ++i) {
      x.push_back(-0.5f + (i % kNumSteps) / 256.f);
      y.push_back(-0.5f + (i / kNumSteps) / 256.f);
    }
    for (int i = 0; i < 8 * kNumSteps; ++i) {
      x.push_back(-0.5f + i / 2048.f);
      y.push_back(1.f);
    }
    for (int i = 0; i < 1000000; ++i) {
      x.push_back((width + 4) * random.NextFloat() - 2.f);
      y.push_back((height + 4) * random.NextFloat() - 2.f);
    }
    const Buffer<float> device_x(*device, x);
    const Buffer<float> device_y(*device, y);
    Buffer<float> values(*device, x.size());
    ParallelFor(
        *device,
        static_cast<int64_t>(x.size()),
        SampleKernel{
            texture.View(), device_x.Data(), device_y.Data(), values.Data()});
    values.ToHost();
  }
}

}  // namespace
}  // namespace tsar
