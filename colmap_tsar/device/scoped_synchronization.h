// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/device/device.h"

namespace tsar {

// Synchronizes the device at the end of a scope, also after an error, so that
// memory that the device still reads and another device may free outlives the
// scope's work.
class ScopedSynchronization {
 public:
  explicit ScopedSynchronization(Device& device) : device_(device) {}
  ~ScopedSynchronization() {
    try {
      device_.Synchronize();
    } catch (const Error&) {
      // The next use of the device reports the error.
    }
  }
  ScopedSynchronization(const ScopedSynchronization&) = delete;
  ScopedSynchronization& operator=(const ScopedSynchronization&) = delete;

 private:
  Device& device_;
};

}  // namespace tsar
