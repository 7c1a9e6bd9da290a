// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// A file format, whose readers are all fed hostile input.
struct FuzzTarget {
  std::string name;
  // They may throw nothing but tsar::Error.
  std::vector<std::function<void(std::span<const uint8_t> input)>> readers;
  // Inputs that are read without an error.
  std::vector<std::string> seeds;
};

std::vector<FuzzTarget> MakeFuzzTargets();

}  // namespace tsar
