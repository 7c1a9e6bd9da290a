// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// The GPUs of TsarRefine.gpu_index: "0,1,3", or nothing for "-1", which means
// every GPU. Throws kBadOption for anything else.
std::vector<int> ParseGpuIndices(const std::string& text);

}  // namespace tsar
