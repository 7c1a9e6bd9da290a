// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>

namespace tsar {

// The limit of main memory of this process in bytes: the machine's memory
// without swap, or the lower limit of a control group, as in containers and
// cluster jobs. INT64_MAX if unknown. root: the folder of /proc and /sys, for
// tests.
int64_t MainMemoryBytes(const std::filesystem::path& root = "/");

}  // namespace tsar
