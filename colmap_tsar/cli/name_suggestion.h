// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// The number of letters to insert, delete or replace to turn a into b.
int EditDistance(const std::string& a, const std::string& b);

// The names that a user who wrote `written` may have meant, nearest first, at
// most three. A name with a group ("TsarRefine.device") is also compared by the
// part after the dot, because the group is easily forgotten.
std::vector<std::string> SuggestNames(const std::string& written,
                                      const std::vector<std::string>& names);

}  // namespace tsar
