// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_folder.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <cerrno>
#include <exception>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The absolute path without a trailing separator.
fs::path Normal(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

Error Refused(const OutputFolderKind& kind,
              const fs::path& path,
              const std::string& what,
              const std::string& advice) {
  return Error::File(
      ErrorCode::kUnsupported,
      path.string(),
      what,
      advice + ", or give another folder as " + OptionName(kind.path_option));
}

std::string TemporaryMarker(const OutputFolderKind& kind) {
  return std::string(kind.unfinished_file) + AtomicFile::kTemporarySuffix;
}

// Whether it is an unfinished folder of this program: one that is empty, holds
// only the marker's temporary file, or is marked.
bool IsUnfinished(const OutputFolderKind& kind, const fs::path& path) {
  if (!fs::is_directory(SymlinkStatus(path))) {
    return false;
  }
  const std::vector<FolderEntry> entries = ListFolder(UserPath(path));
  const auto is_temporary = [&](const FolderEntry& entry) {
    return entry.path.Filename() == TemporaryMarker(kind);
  };
  const auto is_marker = [&](const FolderEntry& entry) {
    return entry.path.Filename() == kind.unfinished_file && !entry.is_folder;
  };
  return std::ranges::all_of(entries, is_temporary) ||
         std::ranges::any_of(entries, is_marker);
}

void Mark(const OutputFolderKind& kind, const fs::path& folder) {
  AtomicFile marker(UserPath(folder) / kind.unfinished_file);
  marker.Stream() << kind.command
                  << " removes this folder when it is called with the same "
                  << OptionName(kind.path_option) << ".\n";
  marker.Commit();
}

// Removes all but the marker.
void EmptyUnfinished(const OutputFolderKind& kind, const fs::path& path) {
  const ContainedPath folder = UserPath(path);
  const fs::path marker = path / kind.unfinished_file;
  const std::vector<FolderEntry> tree = ListTree(folder);
  for (auto entry = tree.rbegin(); entry != tree.rend(); ++entry) {
    if (entry->is_folder) {
      RemoveTree(entry->path);
    } else if (entry->path.Path() != marker) {
      RemoveFile(entry->path);
    }
  }
}

// The marker goes last, so that a killed program leaves a recognizable folder.
void RemoveUnfinished(const OutputFolderKind& kind, const fs::path& path) {
  EmptyUnfinished(kind, path);
  RemoveTree(UserPath(path));
}

// The lock is held until the folder is closed, however the program ends. File
// systems that cannot lock folders cause no warning, since a folder is hardly
// ever written by two programs.
DIR* OpenLocked(const OutputFolderKind& kind, const fs::path& path) {
  CreateFolders(UserPath(path));
  DIR* const folder = opendir(path.c_str());
  if (folder == nullptr && errno != ENOENT) {
    ThrowSystemError(path, "the folder cannot be opened", errno);
  }
  // It may have been removed, or renamed as complete, before it was locked.
  struct stat locked;
  struct stat named;
  if (folder == nullptr ||
      (flock(dirfd(folder), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
      fstat(dirfd(folder), &locked) != 0 || stat(path.c_str(), &named) != 0 ||
      locked.st_ino != named.st_ino) {
    if (folder != nullptr) {
      closedir(folder);
    }
    throw Refused(kind,
                  path,
                  std::string("another ") + kind.command + " is at work there",
                  "wait until it has ended");
  }
  return folder;
}

std::string NameIn(const ContainedPath& folder, const FolderEntry& entry) {
  return entry.path.Relative()
      .lexically_relative(folder.Relative())
      .generic_string();
}

void WriteList(const OutputFolderKind& kind, const fs::path& path) {
  const ContainedPath folder = UserPath(path);
  std::set<std::string> names;
  for (const FolderEntry& entry : ListTree(folder)) {
    if (!entry.is_folder) {
      names.insert(NameIn(folder, entry));
    }
  }
  names.erase(kind.unfinished_file);
  const ContainedPath list = folder / kind.list_file;
  CreateFolders(list.Parent());
  AtomicFile file(list);
  for (const std::string& name : names) {
    file.Stream() << name << "\n";
  }
  file.Stream() << kind.list_file << "\n";
  file.Commit();
}

// The listed files; nothing where the list is missing or incomplete.
std::optional<std::set<std::string>> ReadList(const OutputFolderKind& kind,
                                              const fs::path& path) {
  InputFile file(path / kind.list_file);
  std::set<std::string> names;
  std::string name;
  while (std::getline(file, name)) {
    names.insert(name);
  }
  return names.contains(kind.list_file) ? std::optional(names) : std::nullopt;
}

// Throws where the folder holds anything that is not listed.
void CheckHoldsNothingElse(const OutputFolderKind& kind, const fs::path& path) {
  const std::optional<std::set<std::string>> files = ReadList(kind, path);
  if (!files) {
    throw Refused(kind,
                  path,
                  std::string("holds ") + kind.name_with_a +
                      " without the list of its files (" + kind.list_file +
                      "), so that other files in it would not be noticed",
                  "move or delete it");
  }
  const ContainedPath folder = UserPath(path);
  for (const FolderEntry& entry : ListTree(folder)) {
    const std::string name = NameIn(folder, entry);
    if (!entry.is_folder &&
        (entry.is_link ||
         (!files->contains(name) && name != kind.unfinished_file &&
          name != TemporaryMarker(kind)))) {
      throw Refused(
          kind,
          entry.path,
          std::string("is not of the ") + kind.name + " in this folder",
          "move it away");
    }
  }
}

// Whether there is a folder to be replaced.
bool CheckPlace(const OutputFolderKind& kind,
                const fs::path& path,
                bool overwrite) {
  const fs::file_type type = SymlinkStatus(path).type();
  if (type == fs::file_type::not_found) {
    return false;
  }
  if (type == fs::file_type::symlink) {
    throw Refused(kind, path, "is a link", "remove it");
  }
  if (type == fs::file_type::directory && ListFolder(UserPath(path)).empty()) {
    return false;
  }
  std::error_code error;
  if (!fs::is_regular_file(path / kind.known_file, error)) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      std::string("is there already and is no ") + kind.name,
                      "give another folder as " + OptionName(kind.path_option));
  }
  if (!overwrite) {
    throw Refused(kind,
                  path,
                  std::string("holds ") + kind.name_with_a + " already",
                  "give " + OptionName("overwrite") + " 1 to replace it");
  }
  CheckHoldsNothingElse(kind, path);
  return true;
}

// The name of a former folder where the file system cannot exchange two.
fs::path FormerPath(const fs::path& path) {
  return path.string() + ".tsar_old";
}

void RemoveFormer(const OutputFolderKind& kind, const fs::path& path) {
  if (IsUnfinished(kind, FormerPath(path))) {
    RemoveUnfinished(kind, FormerPath(path));
  }
}

}  // namespace

OutputFolder::OutputFolder(const OutputFolderKind& kind,
                           const fs::path& path,
                           bool overwrite)
    : kind_(kind),
      path_(Normal(path)),
      temporary_(path_.string() + AtomicFile::kTemporarySuffix),
      overwrite_(overwrite) {
  CheckPlace(kind_, path_, overwrite_);
  if (fs::exists(SymlinkStatus(temporary_)) &&
      !IsUnfinished(kind_, temporary_)) {
    // It may be anything, a workspace too: to move it is the second choice.
    throw Error::File(ErrorCode::kUnsupported,
                      temporary_.string(),
                      std::string("is no unfinished ") + kind_.name +
                          ", and its name is needed for one",
                      "give another folder than " + path_.string() + " as " +
                          OptionName(kind_.path_option) + ", or move it away");
  }
  lock_.reset(OpenLocked(kind_, temporary_));
  EmptyUnfinished(kind_, temporary_);  // Remains of a killed program.
  RemoveFormer(kind_, path_);
  try {
    Mark(kind_, temporary_);
  } catch (const Error&) {
    RemoveFolderIfEmpty(UserPath(temporary_));
    throw;
  }
}

OutputFolder::~OutputFolder() {
  try {
    if (lock_ && IsUnfinished(kind_, temporary_)) {
      RemoveUnfinished(kind_, temporary_);
    }
  } catch (const std::exception&) {
    // The next call with the same path removes it.
  }
}

void OutputFolder::Commit() {
  WriteList(kind_, temporary_);
  const ContainedPath from = UserPath(temporary_);
  const ContainedPath to = UserPath(path_);
  // From its new name on, another program may begin under the temporary one,
  // unless the former folder is there, to be removed under its own lock.
  Lock former = {nullptr, &closedir};
  if (CheckPlace(kind_, path_, overwrite_)) {
    former.reset(OpenLocked(kind_, path_));
    Mark(kind_, path_);
    if (renameat2(AT_FDCWD,
                  temporary_.c_str(),
                  AT_FDCWD,
                  path_.c_str(),
                  RENAME_EXCHANGE) != 0) {
      // Not all file systems can.
      RenameFile(to, UserPath(FormerPath(path_)));
      RenameFile(from, to);
      RemoveFormer(kind_, path_);
      former.reset();
    }
    FlushToDisk(to.Parent());
  } else {
    RenameFile(from, to);
  }
  lock_.swap(former);
  RemoveFile(to / kind_.unfinished_file);
}

}  // namespace tsar
