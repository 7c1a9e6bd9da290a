// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace tsar {

// A folder, open as long as this object lives. What is done in it by its
// descriptor is done in this very folder, whatever becomes of its name.
//
// A folder is opened one name after the other, from the root of its path on,
// and at none of them a link is followed (O_NOFOLLOW). Links to folders that
// lead to another place below the root are resolved first. Throws Error:
// kNotFound (no such folder), kUnsupported (a link leads out of the root), kIo.
class Folder {
 public:
  explicit Folder(const ContainedPath& path);
  // Nothing where there is no such folder.
  static std::optional<Folder> OpenIfThere(const ContainedPath& path);
  // Makes it, and those above it, where they are missing. The new names are
  // flushed to the disk, the outermost first.
  static Folder Create(const ContainedPath& path);

  ~Folder();
  Folder(Folder&& other) noexcept;
  Folder& operator=(Folder&& other) noexcept;

  int Descriptor() const { return descriptor_; }
  const ContainedPath& Path() const { return path_; }

  // Makes changes of names durable. Not all file systems can; those that cannot
  // have nothing to flush.
  void Flush() const;

  struct Entry {
    std::string name;
    bool is_folder = false;  // Not a link to one.
    bool is_link = false;
  };
  // What is in it, by name.
  std::vector<Entry> List() const;

 private:
  Folder(const ContainedPath& path, int descriptor)
      : path_(path), descriptor_(descriptor) {}

  ContainedPath path_;
  int descriptor_ = -1;
};

// What is in a folder and all below it; each folder stands before what is in
// it. Links are not followed. Empty where there is no such folder. A folder
// that cannot be listed is an error, since what is in it would count as not
// there; but "lost+found", which is the system's, is passed over.
struct TreeEntry {
  ContainedPath path;
  bool is_folder = false;
  bool is_link = false;
};
std::vector<TreeEntry> ListTree(const ContainedPath& folder);

// The paths of the files below a folder, relative to it, whose names end in
// this suffix, without the suffix.
std::set<std::string> ListFileNames(const ContainedPath& folder,
                                    const std::string& suffix);

// Error kIo that names the path and the system's reason.
[[noreturn]] void ThrowSystemError(const std::filesystem::path& path,
                                   const std::string& what,
                                   int error);

}  // namespace tsar
