// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/device/device.h"

namespace tsar {

// Waits for the device at the end of a scope, also where an error leaves it:
// what the device still reads and another device may free outlives the scope.
class ScopedSynchronization {
 public:
  explicit ScopedSynchronization(Device& device) : device_(device) {}
  ~ScopedSynchronization() {
    try {
      device_.Synchronize();
    } catch (const Error&) {
      // Whoever asks the device for more will hear of it.
    }
  }
  ScopedSynchronization(const ScopedSynchronization&) = delete;
  ScopedSynchronization& operator=(const ScopedSynchronization&) = delete;

 private:
  Device& device_;
};

}  // namespace tsar
