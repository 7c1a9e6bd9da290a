// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>

namespace tsar {

// The main memory that this process may use at most, in bytes: what the machine
// has without its swap space, or less where a control group bounds it, as in
// containers and in jobs of a cluster. INT64_MAX where the system does not
// tell. root: where /proc and /sys are, for tests.
int64_t MainMemoryBytes(const std::filesystem::path& root = "/");

}  // namespace tsar
