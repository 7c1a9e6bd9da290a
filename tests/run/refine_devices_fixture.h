// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/refine_devices.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>

namespace tsar {

constexpr size_t kGigabyte = 1000000000;

// Refinement of images of one megapixel with ten sources each, on a machine
// with these GPUs.
class RefineDevicesTest : public testing::Test {
 protected:
  RefineDevicesTest() {
    overview_.max_num_pixels = 1000000;
    overview_.max_num_sources = 10;
    options_.num_threads = 16;
  }

  GpuSystem Gpus(int num_gpus) {
    return {
        [this, num_gpus] {
          EXPECT_NE(options_.choice, DeviceChoice::kCpu)
              << "the driver is not needed";
          return num_gpus;
        },
        [this](int index) {
          if (without_code_.count(index) > 0 || index < 0) {
            throw Error(
                ErrorCode::kDevice,
                "GPU " + std::to_string(index) + " has no code; build it");
          }
          ++num_created_[index];
          if (num_created_[index] > max_num_devices_) {
            throw Error(ErrorCode::kOutOfMemory,
                        "main memory could not be pinned; close others");
          }
          const size_t memory =
              memory_.count(index) > 0 ? memory_[index] : 8 * kGigabyte;
          return std::unique_ptr<Device>(new CountingDevice("Card", memory));
        }};
  }
  RefineDevices Create(int num_gpus, int num_images = 100) {
    num_created_.clear();
    return CreateRefineDevices(options_,
                               overview_,
                               PlanDefaults,
                               num_images,
                               Gpus(num_gpus),
                               machine_bytes_);
  }
  // Those of the pass that labels all views, where it runs by itself.
  std::vector<GpuWorkers> OpenForLabels(int num_gpus) {
    num_created_.clear();
    return OpenGpus(
        options_, ForLabelsAlone(Plan()), /*num_images=*/100, Gpus(num_gpus));
  }
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     int num_gpus) {
    ExpectError(code, texts, [&] { Create(num_gpus); });
  }

  static MemoryPlan PlanDefaults(const WorkspaceOverview& overview) {
    return PlanRefinement({}, overview);
  }
  MemoryPlan Plan() const { return PlanDefaults(overview_); }

  WorkspaceOverview overview_;
  DeviceOptions options_;
  std::map<int, size_t> memory_;
  std::set<int> without_code_;
  std::map<int, int> num_created_;
  int max_num_devices_ = kMaxGpuWorkers;  // Of each GPU.
  int64_t machine_bytes_ = 64 * static_cast<int64_t>(kGigabyte);
};

// The names of all workers.
inline std::vector<std::string> Names(const RefineDevices& devices) {
  std::vector<std::string> names;
  for (const RefineWorker& worker : devices.workers) {
    names.push_back(worker.name);
  }
  return names;
}

}  // namespace tsar
