// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// Whether there is something under this name. Links are followed; one that
// leads nowhere is nothing. Error kIo where the system does not tell: what may
// not be looked at is not missing.
bool Exists(const std::filesystem::path& path);

// Whether there is a regular file under this name, as Exists().
bool IsFile(const std::filesystem::path& path);

// In lower case, as far as it is ASCII.
std::string FoldedCase(std::string name);

// What to do about a file that is missing: the advice, or, where its folder has
// a file of the same name but for upper and lower case (.JPG and .jpg), to
// rename that.
std::string AdviceForMissing(const std::filesystem::path& path,
                             const std::string& advice);

// What stands under this name itself, be it a link; errors as Exists().
std::filesystem::file_status SymlinkStatus(const std::filesystem::path& path);

// Whether a path is this folder or lies in it, by their names alone.
bool IsWithin(const std::filesystem::path& path,
              const std::filesystem::path& folder);

}  // namespace tsar
