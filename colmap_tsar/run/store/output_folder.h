// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/folder.h"

#include <filesystem>
#include <memory>

namespace tsar {

// What a command writes into a folder of its own. Files are named by their
// paths in the folder.
struct OutputFolderKind {
  const char* name;             // For messages: "report",
  const char* name_with_a;      // "a report".
  const char* command;          // "tsar_report".
  const char* path_option;      // The key of the option that names the folder.
  const char* known_file;       // By it a folder is known to be of this kind.
  const char* list_file;        // Names all files, a line each; itself last.
  const char* unfinished_file;  // The marker, see below.
};

// Such a folder while it is written: everything goes to a temporary folder
// beside it (*.tsar_tmp), which takes its name when all is there. Without
// Commit() the temporary is removed and nothing has changed.
//
// A folder lists its files (list_file) and is replaced only where nothing else
// is in it. What is removed on the way holds a marker (unfinished_file) as long
// as anything is in it, by which the next call knows what a killed program has
// left; without the marker a folder is never touched. A folder that stands
// under its name may hold the marker, too, where the program was killed between
// replacing a former one and its end.
class OutputFolder {
 public:
  // kind must outlive this object. Throws Error: kUnsupported (the folder holds
  // what an earlier call wrote and overwrite is false, such without its list,
  // or anything else; it is a link; beside it stands, under the name of the
  // temporary, what is no unfinished folder; another program is writing it),
  // kIo.
  OutputFolder(const OutputFolderKind& kind,
               const std::filesystem::path& path,
               bool overwrite);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Where to write.
  const std::filesystem::path& Temporary() const { return temporary_; }

  // Lists what was written, puts it into the place of the former folder, in one
  // step where the file system can, and removes that. Throws what the
  // constructor does, since files may have come meanwhile.
  void Commit();

 private:
  // Where the file system cannot exchange two folders.
  void ReplaceInTwoSteps();

  const OutputFolderKind& kind_;
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool overwrite_;
  std::unique_ptr<Folder> lock_;  // The temporary, by which it is locked.
};

}  // namespace tsar
