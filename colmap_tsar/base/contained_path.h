// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// The path of a file or folder that is written to or removed, in two parts: the
// folder that the user named, in whose path links are followed, and the way
// from there, in which no link may lead out of it (see folder.h). Whatever
// changes a workspace takes such paths, so that links which were put in the
// place of its folders cannot lead a write elsewhere.
class ContainedPath {
 public:
  ContainedPath() = default;
  ContainedPath(const std::filesystem::path& root,
                const std::filesystem::path& relative)
      : root_(root),
        relative_(relative),
        path_(relative.empty() ? root : root / relative) {}

  const std::filesystem::path& Root() const { return root_; }
  // Empty for the root itself.
  const std::filesystem::path& Relative() const { return relative_; }

  // The whole, for messages and readers.
  operator const std::filesystem::path&() const { return path_; }
  const std::filesystem::path& Path() const { return path_; }
  std::string string() const { return path_.string(); }

  std::filesystem::path Filename() const { return relative_.filename(); }
  // The folder that it is in; of a root, the root.
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

// A file or folder outside of workspaces, all of whose path the user named:
// only its own name may not be that of a link to a folder.
inline ContainedPath UserPath(const std::filesystem::path& path) {
  return ContainedPath(
      path.has_parent_path() ? path.parent_path() : std::filesystem::path("."),
      path.filename());
}

}  // namespace tsar
