// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/cuda_test.h"

namespace tsar {

void CudaTest::SetUp() {
  if (Device::NumCudaDevices() == 0) {
    GTEST_SKIP() << "no CUDA device: skipped";
  }
  cpu_ = Device::CreateCpu(2);
  cuda_ = Device::CreateCuda(0);
}

void CudaTest::ExpectAlike(const std::string& stage_name,
                           const std::vector<SceneSize>& scenes,
                           const Stage& stage) {
  for (const SceneSize& scene : scenes) {
    const auto run = [&](Device& device) {
      StageInputs inputs(scene, device);
      StageResult result;
      stage(inputs, device, &result);
      return result;
    };
    const StageResult on_cpu = run(*cpu_);
    const StageResult on_cuda = run(*cuda_);
    const StageResult again = run(*cuda_);
    EXPECT_FALSE(on_cpu.Channels().empty()) << stage_name;
    EXPECT_EQ(FindDifferences(on_cpu, on_cuda), "")
        << stage_name << ", " << scene << ": CPU and GPU";
    EXPECT_EQ(FindDifferences(on_cuda, again), "")
        << stage_name << ", " << scene << ": two runs on the GPU";
  }
}

}  // namespace tsar
