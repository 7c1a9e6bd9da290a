// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <nlohmann/json_fwd.hpp>

namespace tsar {

// Writes a file atomically; creates its folder. Names need not be UTF-8:
// invalid bytes become the replacement character. Error kIo.
void WriteJson(const ContainedPath& path, const nlohmann::json& json);

}  // namespace tsar
