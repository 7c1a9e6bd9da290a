// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace tsar {

// All functions of this file throw Error: kUnsupported (a link on the way leads
// out of the root), kIo.

// Throws Error kUnsupported where a link on the way from the root to this
// folder, which need not exist, leads out of the root.
void RequireInside(const ContainedPath& folder);

struct FolderEntry {
  ContainedPath path;
  bool is_folder = false;  // False for a link.
  bool is_link = false;
};

// The entries of a folder, sorted by name. Empty if there is no such folder.
std::vector<FolderEntry> ListFolder(const ContainedPath& folder);

// The entries of a folder and of all below it, each folder before its content.
// Links are not followed. A folder that cannot be listed is an error, since its
// content would appear to be missing; the system's "lost+found" is skipped.
std::vector<FolderEntry> ListTree(const ContainedPath& folder);

// The paths, relative to the folder and without the suffix, of the files below
// it whose names end in the suffix.
std::set<std::string> ListFileNames(const ContainedPath& folder,
                                    const std::string& suffix);

// Warns, in one line, of files in a folder of inputs that belong to no image.
void WarnOfStrayFiles(const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& files);

// Flushes a file, or the names in a folder, to the disk as far as the file
// system can.
void FlushToDisk(const std::filesystem::path& path);

// Throws Error kIo with the path and the system's reason.
[[noreturn]] void ThrowSystemError(const std::filesystem::path& path,
                                   const std::string& what,
                                   int error);

// Throws Error kIo if the path of a file to write is a folder. To be called
// before the content is computed. Links to folders can be replaced.
void RequireNoFolder(const std::filesystem::path& path);

// Removes a file or link if it exists.
void RemoveFile(const ContainedPath& path);

// Removes a folder if it is empty; returns whether it did.
bool RemoveFolderIfEmpty(const ContainedPath& path);

// Removes a folder and its content without following links.
void RemoveTree(const ContainedPath& folder);

}  // namespace tsar
