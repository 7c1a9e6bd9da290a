// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <memory>
#include <ostream>

namespace tsar {

// Writes a file so that its name always stands for a complete file, the old one
// or the new one: the content goes to a temporary name in the same folder, is
// flushed to the disk, and is renamed. Without Commit() the destructor removes
// the temporary and leaves the old file alone.
//
// Every failure is an Error kIo that names the file and the system's reason,
// and removes the temporary. One program at a time may write a given file.
class AtomicFile {
 public:
  // What the temporary names end in. A killed program leaves them behind; the
  // next write of the same file takes their place.
  static constexpr const char* kTemporarySuffix = ".tsar_tmp";

  // The folder must exist.
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;

  // Binary. Failed writes are reported by Prepare() and Commit().
  std::ostream& Stream();

  // Flushes to the disk and closes. Several files can be made ready before the
  // first is renamed. Nothing may be written afterwards.
  void Prepare();

  // Gives the file its name, after Prepare() where that was not called.
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Creates a folder and those above it, and flushes the new names to the disk;
// Error kIo with the system's reason.
void CreateFolders(const std::filesystem::path& path);

// Gives `path` the content of `source` in one step: as a hard link where the
// file system can, otherwise as a copy of the same time. Replaces an existing
// file; creates the folder.
void LinkOrCopyFile(const std::filesystem::path& source,
                    const std::filesystem::path& path);

// Replaces `path` by a copy in one step; Error kIo. keeps_time: the copy gets
// the time of the last change, too, where the file system can.
void CopyFile(const std::filesystem::path& source,
              const std::filesystem::path& path,
              bool keeps_time = false);

// Removes a file where there is one; Error kIo.
void RemoveFile(const std::filesystem::path& path);

// Removes the temporaries of AtomicFile that killed programs left behind, in a
// folder and all below it; Error kIo. Folders of such names stay.
void RemoveTemporaries(const std::filesystem::path& folder);

// Renames and flushes the folder; Error kIo.
void RenameFile(const std::filesystem::path& from,
                const std::filesystem::path& to);

}  // namespace tsar
