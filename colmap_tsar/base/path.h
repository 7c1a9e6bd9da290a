// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// Whether a path exists. Links are followed; a dangling one does not exist.
// Throws Error kIo if unknown: an inaccessible path is not a missing one.
bool Exists(const std::filesystem::path& path);

// Whether a path is a regular file; links and errors as Exists().
bool IsFile(const std::filesystem::path& path);

// The name with its ASCII letters in lower case.
std::string FoldedCase(const std::string& name);

// What to do about a missing file: repair the link if the path is a dangling
// one; rename a file in its folder whose name differs only in case (.JPG and
// .jpg), if there is one; otherwise the given advice.
std::string AdviceForMissing(const std::filesystem::path& path,
                             const std::string& advice);

// The status of the path itself, without following a link; errors as Exists().
std::filesystem::file_status SymlinkStatus(const std::filesystem::path& path);

// Whether a path is this folder or lies in it; compares names only.
bool IsWithin(const std::filesystem::path& path,
              const std::filesystem::path& folder);

}  // namespace tsar
