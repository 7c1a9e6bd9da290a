// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// The path of a file or folder that is written to or removed, in two parts: the
// root folder that the user named, in whose path links are followed, and the
// relative path from there, in which no link may lead out of the root (see
// folder.h). All functions that change a workspace take such paths, so that
// links in place of its folders cannot redirect a write.
class ContainedPath {
 public:
  ContainedPath() = default;
  ContainedPath(const std::filesystem::path& root,
                const std::filesystem::path& relative)
      : root_(root),
        relative_(relative),
        path_(relative.empty() ? root : root / relative) {}

  const std::filesystem::path& Root() const { return root_; }
  // The path relative to the root; empty for the root itself.
  const std::filesystem::path& Relative() const { return relative_; }

  // The full path, for messages and readers.
  operator const std::filesystem::path&() const { return path_; }
  const std::filesystem::path& Path() const { return path_; }
  std::string string() const { return path_.string(); }

  std::filesystem::path Filename() const { return relative_.filename(); }
  // The parent folder; the root is its own parent.
  ContainedPath Parent() const {
    return relative_.has_parent_path()
               ? ContainedPath(root_, relative_.parent_path())
               : ContainedPath(root_, {});
  }
  ContainedPath operator/(const std::filesystem::path& below) const {
    return ContainedPath(root_, relative_.empty() ? below : relative_ / below);
  }

 private:
  std::filesystem::path root_;
  std::filesystem::path relative_;
  std::filesystem::path path_;
};

// A file or folder outside of workspaces whose full path the user named: only
// its last component may not be a link to a folder.
inline ContainedPath UserPath(const std::filesystem::path& path) {
  return ContainedPath(
      path.has_parent_path() ? path.parent_path() : std::filesystem::path("."),
      path.filename());
}

}  // namespace tsar
