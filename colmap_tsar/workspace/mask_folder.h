// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// Throws Error, kBadOption, where a folder of masks is that of the images.
// option: what names the folder.
void RequireNoImageFolder(const std::filesystem::path& masks,
                          const std::filesystem::path& images,
                          const std::string& option);

}  // namespace tsar
