// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/remove_files.h"

#include "colmap_tsar/base/atomic_file.h"

#include <cerrno>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace tsar {
namespace {

// Returns 0 or the system's error number.
int RemoveFolder(const ContainedPath& path) {
  const std::optional<Folder> parent = Folder::OpenIfThere(path.Parent());
  if (!parent) {
    return ENOENT;
  }
  return unlinkat(
             parent->Descriptor(), path.Filename().c_str(), AT_REMOVEDIR) == 0
             ? 0
             : errno;
}

}  // namespace

void RemoveFile(const ContainedPath& path) {
  const std::optional<Folder> folder = Folder::OpenIfThere(path.Parent());
  if (folder &&
      unlinkat(folder->Descriptor(), path.Filename().c_str(), 0) != 0 &&
      errno != ENOENT) {
    ThrowSystemError(path.Path(), "cannot be removed", errno);
  }
}

bool RemoveFolderIfEmpty(const ContainedPath& path) {
  return RemoveFolder(path) == 0;
}

void RemoveEmptyFolders(const ContainedPath& folder) {
  const std::vector<TreeEntry> tree = ListTree(folder);
  for (auto entry = tree.rbegin(); entry != tree.rend(); ++entry) {
    if (entry->is_folder) {
      RemoveFolderIfEmpty(entry->path);
    }
  }
  RemoveFolderIfEmpty(folder);
}

void RemoveTree(const ContainedPath& folder) {
  const std::vector<TreeEntry> tree = ListTree(folder);
  const auto remove_folder = [](const ContainedPath& path) {
    const int error = RemoveFolder(path);
    if (error != 0 && error != ENOENT) {
      ThrowSystemError(path.Path(), "cannot be removed", error);
    }
  };
  for (auto entry = tree.rbegin(); entry != tree.rend(); ++entry) {
    if (entry->is_folder) {
      remove_folder(entry->path);
    } else {
      RemoveFile(entry->path);
    }
  }
  remove_folder(folder);
}

void RemoveTemporaries(const ContainedPath& folder) {
  for (const TreeEntry& entry : ListTree(folder)) {
    if (!entry.is_folder &&
        entry.path.string().ends_with(AtomicFile::kTemporarySuffix)) {
      RemoveFile(entry.path);
    }
  }
}

}  // namespace tsar
