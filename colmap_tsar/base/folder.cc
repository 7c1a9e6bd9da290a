// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/folder.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSystemFolder = "lost+found";

int OpenFolder(const fs::path& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

}  // namespace

Folder::Folder(const ContainedPath& path) : path_(path) {
  std::optional<Folder> folder = OpenIfThere(path);
  if (!folder) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "no such folder",
                      "check that the workspace is complete");
  }
  std::swap(descriptor_, folder->descriptor_);
}

Folder::~Folder() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
}

std::optional<Folder> Folder::OpenIfThere(const ContainedPath& path) {
  RequireInside(path);
  const int descriptor = OpenFolder(path.Path());
  if (descriptor >= 0) {
    return Folder(path, descriptor);
  }
  if (errno != ENOENT) {
    ThrowSystemError(path.Path(), "the folder cannot be opened", errno);
  }
  return std::nullopt;
}

Folder Folder::Create(const ContainedPath& path) {
  RequireInside(path);
  // No thread takes a folder of another one for one that is on the disk.
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  std::error_code error;
  std::vector<fs::path> created;
  for (fs::path folder = fs::absolute(path.Path());
       !fs::exists(folder, error) && folder.has_relative_path();
       folder = folder.parent_path()) {
    created.push_back(folder);
  }
  fs::create_directories(path.Path(), error);
  const int descriptor = error ? -1 : OpenFolder(path.Path());
  if (descriptor < 0) {
    ThrowSystemError(path.Path(),
                     "the folder cannot be created",
                     error ? error.value() : errno);
  }
  for (auto folder = created.rbegin(); folder != created.rend(); ++folder) {
    FlushToDisk(folder->parent_path());
  }
  return Folder(path, descriptor);
}

void Folder::Flush() const { fsync(Descriptor()); }

std::vector<Folder::Entry> Folder::List() const {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator entry(path_.Path(), error), end;
       !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;  // Of an entry that has been removed meanwhile.
    const fs::file_status status = entry->symlink_status(ignored);
    entries.push_back({entry->path().filename().string(),
                       fs::is_directory(status),
                       fs::is_symlink(status)});
  }
  // Another program may have removed it.
  if (error && error != std::errc::no_such_file_or_directory) {
    ThrowSystemError(
        path_.Path(), "the folder cannot be listed", error.value());
  }
  std::ranges::sort(entries, {}, &Entry::name);
  return entries;
}

void RequireInside(const ContainedPath& folder) {
  if (!Exists(folder.Root())) {
    return;
  }
  std::error_code error;
  const fs::path target = fs::weakly_canonical(folder.Path(), error);
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

std::vector<TreeEntry> ListTree(const ContainedPath& folder) {
  std::vector<TreeEntry> tree;
  std::vector<ContainedPath> todo = {folder};
  while (!todo.empty()) {
    const ContainedPath path = std::move(todo.back());
    todo.pop_back();
    const std::optional<Folder> open = Folder::OpenIfThere(path);
    if (!open) {
      continue;  // Removed meanwhile, or never there.
    }
    for (const Folder::Entry& entry : open->List()) {
      if (entry.name == kSystemFolder) {
        continue;
      }
      tree.push_back({path / entry.name, entry.is_folder, entry.is_link});
      if (entry.is_folder) {
        todo.push_back(path / entry.name);
      }
    }
  }
  return tree;
}

std::set<std::string> ListFileNames(const ContainedPath& folder,
                                    const std::string& suffix) {
  std::set<std::string> names;
  for (const TreeEntry& entry : ListTree(folder)) {
    const std::string name =
        entry.path.Path().lexically_relative(folder.Path()).string();
    if (!entry.is_folder && name.ends_with(suffix)) {
      names.insert(name.substr(0, name.size() - suffix.size()));
    }
  }
  return names;
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
  RequireInside(folder);
  std::error_code error;
  fs::remove_all(folder.Path(), error);
  if (error) {
    ThrowSystemError(folder.Path(), "cannot be removed", error.value());
  }
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
