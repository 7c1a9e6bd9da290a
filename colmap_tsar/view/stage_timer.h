// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"

#include <chrono>
#include <map>
#include <string>

namespace tsar {

// Adds the time between its calls to named stages.
class StageTimer {
 public:
  StageTimer(Device& device, std::map<std::string, double>* seconds)
      : device_(device), seconds_(seconds), start_(Clock::now()) {}

  // Waits for the device and adds the time since the last call to this stage.
  void Finish(const std::string& stage) {
    device_.Synchronize();
    const Clock::time_point now = Clock::now();
    (*seconds_)[stage] += std::chrono::duration<double>(now - start_).count();
    start_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Device& device_;
  std::map<std::string, double>* seconds_;
  Clock::time_point start_;
};

}  // namespace tsar
