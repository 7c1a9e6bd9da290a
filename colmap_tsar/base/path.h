// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tsar {

// Whether a path exists. Links are followed; a dangling one does not exist.
// Throws Error kIo if unknown: an inaccessible path is not a missing one.
bool Exists(const std::filesystem::path& path);

// Whether a path is a regular file; links and errors as Exists().
bool IsFile(const std::filesystem::path& path);

// In lower case, as far as it is ASCII.
std::string FoldedCase(const std::string& name);

// What to do about a file that is missing: the advice or, where the path is a
// dangling link, to mend that or, where its folder has a file of the same name
// but for upper and lower case (.JPG and .jpg), to rename that.
std::string AdviceForMissing(const std::filesystem::path& path,
                             const std::string& advice);

// What stands under this name itself, be it a link; errors as Exists().
std::filesystem::file_status SymlinkStatus(const std::filesystem::path& path);

// Whether a path is this folder or lies in it; compares names only.
bool IsWithin(const std::filesystem::path& path,
              const std::filesystem::path& folder);

}  // namespace tsar
