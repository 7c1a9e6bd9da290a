// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <ctime>
#include <filesystem>

namespace tsar {

// The modification time of a file in nanoseconds; 0 if there is no file.
int64_t TimeOf(const std::filesystem::path& path);
int64_t ToNanoseconds(const timespec& time);

}  // namespace tsar
