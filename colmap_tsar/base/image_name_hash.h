// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>

namespace tsar {

// The 32-bit FNV-1a hash of an image's name, which keys its random numbers, so
// that they depend neither on the other images nor on their order.
uint32_t HashImageName(const std::string& name);

}  // namespace tsar
