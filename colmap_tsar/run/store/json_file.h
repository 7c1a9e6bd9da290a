// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <nlohmann/json_fwd.hpp>

namespace tsar {

// Writes a file in one step; creates its folder. Names need not be UTF-8: the
// replacement character stands for bytes that are not. Error kIo.
void WriteJson(const ContainedPath& path, const nlohmann::json& json);
// The same, for readers to whom the order of keys matters.
void WriteOrderedJson(const ContainedPath& path,
                      const nlohmann::ordered_json& json);

}  // namespace tsar
