// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Runs the tests of the stages on the CPU and then on the first GPU, where they
// must copy the same bytes to the host.

#include "colmap_tsar/device/cuda_device.h"

#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "tests/run/counting_device.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Hashes of what one test copied to the host. Threads copy in any order.
std::mutex mutex;
std::multiset<size_t> copies;
bool is_on_gpu = false;

void Record(const void* memory, size_t size) {
  const std::lock_guard lock(mutex);
  copies.insert(
      std::hash<std::string_view>()({static_cast<const char*>(memory), size}));
}

class RecordedCpu : public CountingDevice {
 public:
  explicit RecordedCpu(int num_threads)
      : CountingDevice("CPU", std::numeric_limits<size_t>::max(), num_threads) {
  }
  void CopyToHost(void* target, const void* source, size_t size) override {
    CountingDevice::CopyToHost(target, source, size);
    Record(target, size);
  }
};

class RecordedGpu : public CudaDevice {
 public:
  RecordedGpu() : CudaDevice(0) {}
  void CopyToHost(void* target, const void* source, size_t size) override {
    CudaDevice::CopyToHost(target, source, size);
    Record(target, size);
  }
};

// The first iteration is on the CPU.
class CompareWithCpu : public testing::EmptyTestEventListener {
 public:
  void OnTestIterationStart(const testing::UnitTest& /*all*/,
                            int iteration) override {
    is_on_gpu = iteration > 0;
  }
  void OnTestStart(const testing::TestInfo& /*test*/) override {
    copies.clear();
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const std::string name =
        std::string(test.test_suite_name()) + "." + test.name();
    if (!is_on_gpu) {
      copies_on_cpu_[name] = copies;
      return;
    }
    EXPECT_EQ(copies, copies_on_cpu_[name])
        << "what is copied to the host on the GPU and on the CPU";
  }

 private:
  std::map<std::string, std::multiset<size_t>> copies_on_cpu_;
};

class NeedsGpu : public testing::Environment {
 public:
  void SetUp() override {
    if (Device::NumCudaDevices() == 0) {
      GTEST_SKIP() << "needs a GPU";
    }
  }
};

}  // namespace

std::unique_ptr<Device> CreateTestDevice(int num_threads) {
  if (is_on_gpu) {
    return std::make_unique<RecordedGpu>();
  }
  return std::make_unique<RecordedCpu>(num_threads);
}

}  // namespace tsar

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::AddGlobalTestEnvironment(new tsar::NeedsGpu);
  testing::UnitTest::GetInstance()->listeners().Append(
      new tsar::CompareWithCpu);
  GTEST_FLAG_SET(repeat, 2);
  return RUN_ALL_TESTS();
}
