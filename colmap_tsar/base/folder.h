// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// A folder, open as long as this object lives. All functions of this file throw
// Error: kUnsupported (a link on the way leads out of the root), kIo.
class Folder {
 public:
  // Throws Error kNotFound if there is no such folder.
  explicit Folder(const ContainedPath& path);
  ~Folder();
  Folder(Folder&& other) noexcept
      : path_(std::move(other.path_)),
        descriptor_(std::exchange(other.descriptor_, -1)) {}
  Folder& operator=(Folder&&) = delete;

  // Returns nullopt if there is no such folder.
  static std::optional<Folder> OpenIfThere(const ContainedPath& path);
  // Creates the folder and its parents if missing and flushes the new names to
  // the disk.
  static Folder Create(const ContainedPath& path);

  int Descriptor() const { return descriptor_; }
  const ContainedPath& Path() const { return path_; }

  // Flushes changes of names to the disk. File systems without support for it
  // have nothing to flush.
  void Flush() const;

  struct Entry {
    std::string name;
    bool is_folder = false;  // False for a link.
    bool is_link = false;
  };
  // The entries, sorted by name.
  std::vector<Entry> List() const;

 private:
  Folder(const ContainedPath& path, int descriptor)
      : path_(path), descriptor_(descriptor) {}

  ContainedPath path_;
  int descriptor_ = -1;
};

// Throws Error kUnsupported where a link on the way from the root to this
// folder, which need not exist, leads out of the root.
void RequireInside(const ContainedPath& folder);

// The entries of a folder and of all below it, each folder before its content.
// Links are not followed. Empty if there is no such folder. A folder that
// cannot be listed is an error, since its content would count as missing; the
// system's "lost+found" is skipped.
struct TreeEntry {
  ContainedPath path;
  bool is_folder = false;
  bool is_link = false;
};
std::vector<TreeEntry> ListTree(const ContainedPath& folder);

// The paths, relative to the folder and without the suffix, of the files below
// it whose names end in the suffix.
std::set<std::string> ListFileNames(const ContainedPath& folder,
                                    const std::string& suffix);

// Flushes a file, or the names in a folder, to the disk as far as the file
// system can.
void FlushToDisk(const std::filesystem::path& path);

// Throws Error kIo with the path and the system's reason.
[[noreturn]] void ThrowSystemError(const std::filesystem::path& path,
                                   const std::string& what,
                                   int error);

// Throws Error kIo where a folder stands under the name of a file to write, to
// be called before the content is computed. Links to folders can be replaced.
void RequireNoFolder(const std::filesystem::path& path);

// Removes a file or link if it exists.
void RemoveFile(const ContainedPath& path);

// Removes a folder if it is empty; returns whether it did.
bool RemoveFolderIfEmpty(const ContainedPath& path);

// Removes this folder and those below it as far as they are empty.
void RemoveEmptyFolders(const ContainedPath& folder);

// Removes a folder and its content without following links.
void RemoveTree(const ContainedPath& folder);

// Removes the temporaries of AtomicFile that killed programs left behind, in a
// folder and all below it, but no folders of such names.
void RemoveTemporaries(const ContainedPath& folder);

}  // namespace tsar
