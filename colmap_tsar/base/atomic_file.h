// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <ostream>

namespace tsar {

// Writes a file so that its name always stands for a complete file, the old one
// or the new one: the content goes to a temporary name in the same folder, is
// flushed to the disk, and is renamed. Without Commit() the destructor removes
// the temporary and leaves the old file alone. The new file has the permissions
// of the old one and, where that is permitted, its owner.
//
// Every failure is an Error kIo that names the file and the system's reason,
// and removes the temporary. One program at a time may write a given file.
class AtomicFile {
 public:
  // What the temporary names end in. A killed program leaves them behind; the
  // next write of the same file takes their place.
  static constexpr const char* kTemporarySuffix = ".tsar_tmp";

  // The folder must exist; see folder.h for what else may be wrong with it.
  explicit AtomicFile(const ContainedPath& path);
  ~AtomicFile();
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;

  // Binary; seekp(position) goes back to what was written. Failed writes are
  // reported by Prepare() and Commit().
  std::ostream& Stream();

  // Flushes to the disk and closes. Several files can be made ready before the
  // first is renamed. Nothing may be written afterwards.
  void Prepare();

  // That of the new file's last change, in nanoseconds; after Prepare().
  int64_t Time() const;

  // Gives the file its name, after Prepare() where that was not called.
  void Commit();

 private:
  friend void CopyFile(const std::filesystem::path& source,
                       const ContainedPath& path,
                       bool keeps_time);
  struct State;
  std::unique_ptr<State> state_;
};

// Creates a folder and those above it, and flushes the new names to the disk;
// Error kIo with the system's reason.
void CreateFolders(const ContainedPath& path);

// Gives `path` the content of `source` in one step: as a hard link where the
// file system can, otherwise as a copy of the same time. Replaces an existing
// file; creates the folder.
void LinkOrCopyFile(const std::filesystem::path& source,
                    const ContainedPath& path);

// Replaces `path` by a copy with the permissions of the source, in one step;
// Error kIo. keeps_time: the copy gets the time of the last change, too, where
// the file system can.
void CopyFile(const std::filesystem::path& source,
              const ContainedPath& path,
              bool keeps_time = false);

// Renames and flushes the folder; Error kIo. Creates no folder. Between file
// systems, files are copied and the former name is removed then.
void RenameFile(const ContainedPath& from, const ContainedPath& to);

// Exchanges what two names stand for, in one step, and flushes the folders;
// false where the file system cannot, and nothing has changed. Error kIo.
bool ExchangeFiles(const ContainedPath& first, const ContainedPath& second);

// Removes a file or link where there is one; Error kIo.
void RemoveFile(const ContainedPath& path);

// Removes a folder where nothing is in it; whether it did.
bool RemoveFolderIfEmpty(const ContainedPath& path);

// Removes the folders below this one, and this one, in which nothing is.
void RemoveEmptyFolders(const ContainedPath& folder);

// Removes a folder with all that is in it, links themselves and not what they
// lead to; Error kIo.
void RemoveTree(const ContainedPath& folder);

// Removes the temporaries of AtomicFile that killed programs left behind, in a
// folder and all below it; Error kIo. Folders of such names stay.
void RemoveTemporaries(const ContainedPath& folder);

}  // namespace tsar
