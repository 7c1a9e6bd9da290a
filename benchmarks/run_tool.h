// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdio>
#include <exception>

namespace tsar {

// The exit code of a tool that does this work, which throws where something is
// wrong; then one line says what.
template <typename Work>
int RunTool(const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ERROR: %s\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace tsar
