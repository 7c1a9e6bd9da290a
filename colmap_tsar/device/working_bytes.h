// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Every stage says by a function ...WorkingBytes() how many bytes of the
// device's memory it holds at a time at most: its result and all that it needs
// on the way, but not its inputs. The function stands beside the stage, so that
// a run can be planned without knowing what the stages allocate. A stage that
// allocates nothing but a raster as its result needs none.

#include <cstdint>

namespace tsar {

// A Buffer or DeviceImage of this many elements.
template <typename T>
constexpr int64_t BytesOf(int64_t num_elements) {
  return num_elements * static_cast<int64_t>(sizeof(T));
}

}  // namespace tsar
