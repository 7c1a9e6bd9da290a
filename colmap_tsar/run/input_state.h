// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// What a result was made from, as fingerprints by the names of its parts, by
// which a later run sees what has changed.
using InputState = std::map<std::string, std::string>;

// Fingerprints have 16 hexadecimal digits.
std::string FingerprintOf(const std::string& text);
std::string FingerprintOf(const Camera& camera);

// Size and time of last change, or "-" where there is no such file. Links are
// followed.
std::string FileState(const std::filesystem::path& path);

// Something that changed: "its photo", "its maps".
struct ChangedInput {
  std::string name;
  bool is_plural = false;
};

// "its camera, its photo and its maps have changed"; at least one.
std::string DescribeChanges(const std::vector<ChangedInput>& changes);

}  // namespace tsar
