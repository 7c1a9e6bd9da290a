// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// "colmap_tsar 1.2.3 (with CUDA)", or "(without CUDA)" where the GPU part was
// not built.
std::string VersionText();

}  // namespace tsar
