// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

namespace tsar {

// Bytes of a Buffer or DeviceImage of this many elements.
template <typename T>
constexpr int64_t BytesOf(int64_t num_elements) {
  return num_elements * static_cast<int64_t>(sizeof(T));
}

}  // namespace tsar
