// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// The inputs of a result, as fingerprints by input name, from which a later run
// sees which inputs have changed.
using InputState = std::map<std::string, std::string>;

// Fingerprints have 16 hexadecimal digits.
std::string FingerprintOf(const std::string& text);
std::string FingerprintOf(const Camera& camera);

// Size and time of last change, or "-" where there is no such file. Follows
// links.
std::string FileState(const std::filesystem::path& path);

// An input that changed: "its photo", "its maps".
struct ChangedInput {
  std::string name;
  bool is_plural = false;
};

// "its camera, its photo and its maps have changed"; at least one change.
std::string DescribeChanges(const std::vector<ChangedInput>& changes);

}  // namespace tsar
