// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <memory>

#include <dirent.h>

namespace tsar {

// A kind of folder that a command writes. Files are named by their paths in the
// folder.
struct OutputFolderKind {
  const char* name;             // For messages: "report",
  const char* name_with_a;      // "a report".
  const char* command;          // "tsar_report".
  const char* path_option;      // The key of the option that names the folder.
  const char* known_file;       // Identifies a folder of this kind.
  const char* list_file;        // Lists all files, one per line; itself last.
  const char* unfinished_file;  // The marker, see below.
};

// An output folder while it is written: all files go to a temporary folder
// beside it (*.tsar_tmp), which takes its name when complete. Without Commit()
// the temporary folder is removed and nothing has changed.
//
// A folder lists its files (list_file) and is replaced only where it holds
// nothing else. A folder that is being removed holds a marker (unfinished_file)
// until it is empty, by which the next call recognizes the remains of a killed
// program; without the marker a folder is never touched.
class OutputFolder {
 public:
  // kind must outlive this object. Throws Error: kUnsupported (the folder holds
  // an earlier result and overwrite is false, or one without its list, or
  // anything else; it is a link; the name of the temporary folder is taken by
  // anything but an unfinished folder; another program is writing it), kIo.
  OutputFolder(const OutputFolderKind& kind,
               const std::filesystem::path& path,
               bool overwrite);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // The folder to write to.
  const std::filesystem::path& Temporary() const { return temporary_; }

  // Lists the written files and replaces the former folder, atomically where
  // the file system can exchange two. This object's destructor removes the
  // former one. Throws what the constructor throws, since files may have been
  // added meanwhile.
  void Commit();

 private:
  const OutputFolderKind& kind_;
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool overwrite_;
  // The temporary folder, open with a lock; none where it is another's.
  using Lock = std::unique_ptr<DIR, int (*)(DIR*)>;
  Lock lock_ = {nullptr, &closedir};
};

}  // namespace tsar
