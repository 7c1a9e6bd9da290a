// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Every stage on the GPU gives the bits of the same stage on the CPU.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/cuda/scenes.h"
#include "tests/cuda/stage_result.h"
#include <gtest/gtest.h>

namespace tsar {

// Its tests are skipped where there is no GPU.
class CudaTest : public testing::Test {
 protected:
  // Runs in each scene and on each device; adds what it computes.
  using Stage = std::function<void(StageInputs&, Device&, StageResult*)>;

  void SetUp() override;

  // Expects the CPU and the GPU to give the same bits, and two runs on the GPU.
  void ExpectAlike(const std::string& stage_name,
                   const std::vector<SceneSize>& scenes,
                   const Stage& stage);

  std::unique_ptr<Device> cpu_;
  std::unique_ptr<Device> cuda_;
};

}  // namespace tsar
