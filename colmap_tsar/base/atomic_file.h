// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <memory>
#include <ostream>

namespace tsar {

// Writes a file so that its name always refers to a complete file, old or new:
// the content goes to a temporary name in the same folder, is flushed to the
// disk, and is renamed. Without Commit() the destructor removes the temporary
// and leaves the old file alone. The new file has the permissions of the old
// one and, where that is permitted, its owner.
//
// Failures throw Error kIo with the file and the system's reason; kUnsupported
// while another program writes the file.
class AtomicFile {
 public:
  // Suffix of the temporary names. A killed program leaves its temporary file
  // behind; the next write of the same file replaces it. For a file that the
  // user named (UserPath), anything else of that name is an error.
  static constexpr const char* kTemporarySuffix = ".tsar_tmp";

  // The folder must exist, and neither the file's name nor its temporary name
  // may be that of a folder; see folder.h for other errors.
  explicit AtomicFile(const ContainedPath& path);
  ~AtomicFile();
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;

  // The binary stream of the content; seekp(position) may go back. Failed
  // writes throw, at the latest in Prepare().
  std::ostream& Stream();

  // Flushes to the disk and closes, so that several files can be complete
  // before the first is renamed. Nothing may be written afterwards.
  void Prepare();

  // Renames the file to its final name; calls Prepare() first if needed.
  void Commit();

 private:
  friend void CopyFile(const std::filesystem::path& source,
                       const ContainedPath& path,
                       bool keeps_time);
  struct State;
  std::unique_ptr<State> state_;
};

// Creates a folder and its parents, and flushes the new names to the disk.
// Throws Error kIo with the system's reason.
void CreateFolders(const ContainedPath& path);

// Gives `path` the content of `source` atomically: as a hard link if the file
// system supports it, otherwise as a copy with the same time. Replaces an
// existing file; creates the folder.
void LinkOrCopyFile(const std::filesystem::path& source,
                    const ContainedPath& path);

// Replaces `path` atomically by a copy with the permissions of the source.
// Throws Error kIo, and kNotFound without a source. keeps_time: whether the
// copy gets the modification time, too, if the file system supports it.
void CopyFile(const std::filesystem::path& source,
              const ContainedPath& path,
              bool keeps_time = false);

// Renames a file and flushes the folder. Throws Error kIo. Creates no folder.
// Across file systems, the file is copied and the old name removed.
void RenameFile(const ContainedPath& from, const ContainedPath& to);

}  // namespace tsar
