// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/folder.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace tsar {

namespace fs = std::filesystem;

void RequireInside(const ContainedPath& folder) {
  if (!Exists(folder.Root())) {
    return;
  }
  std::error_code error;
  fs::path target;
  do {  // Again where another program has just removed a folder on the way.
    target = fs::weakly_canonical(folder.Path(), error);
  } while (error == std::errc::no_such_file_or_directory);
  if (error) {
    ThrowSystemError(folder.Path(), "cannot be looked at", error.value());
  }
  if (!IsWithin(target, fs::canonical(folder.Root()))) {
    throw Error::File(
        ErrorCode::kUnsupported,
        folder.string(),
        "leads out of the workspace by a link, to " + target.string(),
        "put a folder in its place, or refine with " +
            OptionName("output_path"));
  }
}

std::vector<FolderEntry> ListFolder(const ContainedPath& folder) {
  RequireInside(folder);
  std::vector<FolderEntry> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder.Path(), error), end;
       !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;  // Of an entry that has been removed meanwhile.
    const fs::file_status status = entry->symlink_status(ignored);
    entries.push_back({folder / entry->path().filename(),
                       fs::is_directory(status),
                       fs::is_symlink(status)});
  }
  // Another program may have removed it.
  if (error && error != std::errc::no_such_file_or_directory) {
    ThrowSystemError(
        folder.Path(), "the folder cannot be listed", error.value());
  }
  std::ranges::sort(entries, {}, [](const FolderEntry& entry) {
    return entry.path.Path().native();
  });
  return entries;
}

std::vector<FolderEntry> ListTree(const ContainedPath& folder) {
  std::vector<FolderEntry> tree;
  std::vector<ContainedPath> todo = {folder};
  while (!todo.empty()) {
    const ContainedPath path = std::move(todo.back());
    todo.pop_back();
    for (const FolderEntry& entry : ListFolder(path)) {
      if (entry.path.Filename() == "lost+found") {
        continue;
      }
      tree.push_back(entry);
      if (entry.is_folder) {
        todo.push_back(entry.path);
      }
    }
  }
  return tree;
}

std::set<std::string> ListFileNames(const ContainedPath& folder,
                                    const std::string& suffix) {
  std::set<std::string> names;
  for (const FolderEntry& entry : ListTree(folder)) {
    const std::string name =
        entry.path.Path().lexically_relative(folder.Path()).string();
    if (!entry.is_folder && name.ends_with(suffix)) {
      names.insert(name.substr(0, name.size() - suffix.size()));
    }
  }
  return names;
}

void WarnOfStrayFiles(const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& files) {
  if (!files.empty()) {
    Warn(folder.string() + ": " + std::to_string(files.size()) +
         (files.size() == 1 ? " file belongs to no image, such as "
                            : " files belong to no image, such as ") +
         files.front().string());
  }
}

void FlushToDisk(const fs::path& path) {
  const int descriptor =
      open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
}

void ThrowSystemError(const std::filesystem::path& path,
                      const std::string& what,
                      int error) {
  throw Error::File(ErrorCode::kIo,
                    path.string(),
                    what + " (" + std::strerror(error) + ")",
                    error == EISDIR
                        ? "move the folder of this name away"
                        : "check the free space and the permissions there");
}

void RequireNoFolder(const fs::path& path) {
  if (fs::is_directory(SymlinkStatus(path))) {
    ThrowSystemError(path, "cannot be written", EISDIR);
  }
}

void RemoveFile(const ContainedPath& path) {
  RequireInside(path.Parent());
  if (unlink(path.Path().c_str()) != 0 && errno != ENOENT) {
    ThrowSystemError(path.Path(), "cannot be removed", errno);
  }
}

bool RemoveFolderIfEmpty(const ContainedPath& path) {
  RequireInside(path.Parent());
  return rmdir(path.Path().c_str()) == 0;
}

void RemoveTree(const ContainedPath& folder) {
  RequireInside(folder);
  std::error_code error;
  fs::remove_all(folder.Path(), error);
  if (error) {
    ThrowSystemError(folder.Path(), "cannot be removed", error.value());
  }
}

}  // namespace tsar
