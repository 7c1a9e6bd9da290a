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
#include <memory>
#include <system_error>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSystemFolder = "lost+found";

// O_PATH needs the permission to search alone.
constexpr int kOnTheWay = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
constexpr int kAtTheEnd = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

int OpenEnd(int parent, const char* name) {
  const int descriptor = openat(parent, name, kAtTheEnd);
  // Files can be written in a folder that may not be listed.
  return descriptor < 0 && errno == EACCES ? openat(parent, name, kOnTheWay)
                                           : descriptor;
}

bool IsLink(int parent, const char* name) {
  struct stat state;
  return fstatat(parent, name, &state, AT_SYMLINK_NOFOLLOW) == 0 &&
         S_ISLNK(state.st_mode);
}

struct Walk {
  OwnedDescriptor folder{-1};
  int error = 0;
  bool met_link = false;
  fs::path at;  // The current folder.
};

Walk WalkDown(const fs::path& root, const fs::path& relative, bool creates) {
  Walk walk;
  std::vector<std::string> names;
  for (const fs::path& name : relative) {
    if (name == "..") {
      walk.error = EINVAL;
      walk.at = root / relative;
      return walk;
    }
    if (!name.empty() && name != ".") {
      names.push_back(name.string());
    }
  }
  walk.at = root;
  // Links are followed in the root, which the user named.
  const int from_root = names.empty() ? kAtTheEnd : kOnTheWay;
  walk.folder = OwnedDescriptor(open(root.c_str(), from_root & ~O_NOFOLLOW));
  if (walk.folder.Get() < 0) {
    walk.error = errno;
    return walk;
  }
  for (size_t i = 0; i < names.size(); ++i) {
    const char* name = names[i].c_str();
    walk.at /= names[i];
    const auto step = [&] {
      return i + 1 == names.size() ? OpenEnd(walk.folder.Get(), name)
                                   : openat(walk.folder.Get(), name, kOnTheWay);
    };
    int next = step();
    if (next < 0 && errno == ENOENT && creates) {
      if (mkdirat(walk.folder.Get(), name, 0777) == 0) {
        // O_PATH descriptors cannot be flushed.
        const OwnedDescriptor parent(openat(walk.folder.Get(), ".", kAtTheEnd));
        if (parent.Get() >= 0) {
          fsync(parent.Get());
        }
      } else if (errno != EEXIST) {
        walk.error = errno;
        return walk;
      }
      next = step();
    }
    if (next < 0) {
      walk.error = errno;
      walk.met_link = (errno == ELOOP || errno == ENOTDIR) &&
                      IsLink(walk.folder.Get(), name);
      return walk;
    }
    walk.folder = OwnedDescriptor(next);
  }
  return walk;
}

// The path relative to `root`, which is canonical, of the folder that
// `path.Relative()` resolves to, which need not exist.
fs::path ResolveInside(const fs::path& root,
                       const ContainedPath& path,
                       const fs::path& link) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path.Path(), error);
  const auto [end, rest] =
      std::mismatch(root.begin(), root.end(), target.begin(), target.end());
  if (error || end != root.end()) {
    const fs::path shown = error ? fs::read_symlink(link, error) : target;
    throw Error::File(
        ErrorCode::kUnsupported,
        link.string(),
        "is a link that leads out of the workspace, to " + shown.string(),
        "put a folder in its place, or refine with " +
            OptionName("output_path"));
  }
  return target.lexically_relative(root);
}

Walk OpenChain(const ContainedPath& path, bool creates) {
  Walk walk = WalkDown(path.Root(), path.Relative(), creates);
  if (!walk.met_link) {
    return walk;
  }
  std::error_code error;
  const fs::path root = fs::canonical(path.Root(), error);
  const fs::path relative = ResolveInside(root, path, walk.at);
  Walk again = WalkDown(root, relative, creates);
  if (again.met_link) {
    throw Error::File(ErrorCode::kUnsupported,
                      walk.at.string(),
                      "is a link that leads to no folder",
                      "put a folder in its place");
  }
  return again;
}

// Returns 0 or the system's error number.
int RemoveFolder(const ContainedPath& path) {
  const std::optional<Folder> parent = Folder::OpenIfThere(path.Parent());
  if (!parent) {
    return ENOENT;
  }
  return unlinkat(
             parent->Descriptor(), path.Filename().c_str(), AT_REMOVEDIR) == 0
             ? 0
             : errno;
}

}  // namespace

OwnedDescriptor::~OwnedDescriptor() {
  if (value_ >= 0) {
    close(value_);
  }
}

Folder::Folder(const ContainedPath& path) : path_(path) {
  std::optional<Folder> folder = OpenIfThere(path);
  if (!folder) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "no such folder",
                      "check that the workspace is complete");
  }
  descriptor_ = std::move(folder->descriptor_);
}

std::optional<Folder> Folder::OpenIfThere(const ContainedPath& path) {
  Walk walk = OpenChain(path, false);
  if (walk.error == ENOENT) {
    return std::nullopt;
  }
  if (walk.error != 0) {
    ThrowSystemError(path.Path(), "the folder cannot be opened", walk.error);
  }
  return Folder(path, std::move(walk.folder));
}

Folder Folder::Create(const ContainedPath& path) {
  Walk walk = OpenChain(path, true);
  if (walk.error == ENOENT && walk.at == path.Root()) {
    // The root, which the user named.
    const fs::path root = fs::absolute(path.Root()).lexically_normal();
    if (root.has_relative_path()) {
      Create(UserPath(root.has_filename() ? root : root.parent_path()));
      walk = OpenChain(path, true);
    }
  }
  if (walk.error != 0) {
    ThrowSystemError(path.Path(), "the folder cannot be created", walk.error);
  }
  return Folder(path, std::move(walk.folder));
}

void Folder::Flush() const { fsync(Descriptor()); }

std::vector<Folder::Entry> Folder::List() const {
  // A separate descriptor is used, since listing moves its position.
  OwnedDescriptor descriptor(openat(Descriptor(), ".", kAtTheEnd));
  const auto close_list = [](DIR* list) { closedir(list); };
  std::unique_ptr<DIR, decltype(close_list)> list(
      descriptor.Get() < 0 ? nullptr : fdopendir(descriptor.Get()), close_list);
  if (!list) {
    ThrowSystemError(path_.Path(), "the folder cannot be listed", errno);
  }
  descriptor.Release();
  std::vector<Entry> entries;
  errno = 0;
  while (const dirent* found = readdir(list.get())) {
    Entry entry;
    entry.name = found->d_name;
    if (entry.name != "." && entry.name != "..") {
      unsigned char type = found->d_type;
      struct stat state;
      if (type == DT_UNKNOWN &&
          fstatat(Descriptor(), found->d_name, &state, AT_SYMLINK_NOFOLLOW) ==
              0) {
        type = IFTODT(state.st_mode);
      }
      entry.is_folder = type == DT_DIR;
      entry.is_link = type == DT_LNK;
      entries.push_back(std::move(entry));
    }
    errno = 0;
  }
  if (errno != 0) {
    ThrowSystemError(path_.Path(), "the folder cannot be listed", errno);
  }
  std::ranges::sort(entries, {}, &Entry::name);
  return entries;
}

std::vector<TreeEntry> ListTree(const ContainedPath& folder) {
  std::vector<TreeEntry> tree;
  // Each folder is closed before those below it are opened: two descriptors
  // suffice for a tree of any depth.
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
  const std::optional<Folder> folder = Folder::OpenIfThere(path.Parent());
  if (folder &&
      unlinkat(folder->Descriptor(), path.Filename().c_str(), 0) != 0 &&
      errno != ENOENT) {
    ThrowSystemError(path.Path(), "cannot be removed", errno);
  }
}

bool RemoveFolderIfEmpty(const ContainedPath& path) {
  return RemoveFolder(path) == 0;
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
  const std::vector<TreeEntry> tree = ListTree(folder);
  const auto remove_folder = [](const ContainedPath& path) {
    const int error = RemoveFolder(path);
    if (error != 0 && error != ENOENT) {
      ThrowSystemError(path.Path(), "cannot be removed", error);
    }
  };
  for (auto entry = tree.rbegin(); entry != tree.rend(); ++entry) {
    if (entry->is_folder) {
      remove_folder(entry->path);
    } else {
      RemoveFile(entry->path);
    }
  }
  remove_folder(folder);
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
