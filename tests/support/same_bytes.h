// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstring>

namespace tsar {

template <typename T>
bool SameBytes(const Image<T>& a, const Image<T>& b) {
  return a.HasSizeOf(b) &&
         (a.Empty() ||
          std::memcmp(a.Data(), b.Data(), a.NumPixels() * sizeof(T)) == 0);
}

}  // namespace tsar
