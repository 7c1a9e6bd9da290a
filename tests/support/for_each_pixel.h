// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <gtest/gtest.h>

namespace tsar {

// Calls visit(x, y) for the pixels of [x_begin, x_end) x [y_begin, y_end), row
// by row, until one fails an ASSERT.
template <typename Function>
void ForEachPixel(
    int x_begin, int x_end, int y_begin, int y_end, const Function& visit) {
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      visit(x, y);
      if (testing::Test::HasFatalFailure()) {
        return;
      }
    }
  }
}

template <typename Function>
void ForEachPixel(int width, int height, const Function& visit) {
  ForEachPixel(0, width, 0, height, visit);
}

}  // namespace tsar
