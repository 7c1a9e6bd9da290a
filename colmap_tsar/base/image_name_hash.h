// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>

namespace tsar {

// Keys the random numbers of an image by its name alone, so that they depend
// neither on the other images nor on their order: 32-bit FNV-1a.
uint32_t HashImageName(const std::string& name);

}  // namespace tsar
