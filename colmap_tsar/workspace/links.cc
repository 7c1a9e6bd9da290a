// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/links.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/output_workspace.h"

#include <algorithm>
#include <system_error>

namespace tsar {

void ReplaceByLink(const std::filesystem::path& target,
                   const std::filesystem::path& link) {
  std::error_code error;
  const std::filesystem::path canonical =
      std::filesystem::canonical(target, error);
  if (!error && std::filesystem::is_symlink(link) &&
      std::filesystem::read_symlink(link) == canonical) {
    return;
  }
  CreateFolders(link.parent_path());
  std::filesystem::path temporary = link;
  temporary += AtomicFile::kTemporarySuffix;
  if (!error) {
    std::filesystem::remove(temporary, error);
  }
  if (!error) {
    std::filesystem::create_symlink(canonical, temporary, error);
  }
  if (error) {
    throw Error::File(ErrorCode::kIo,
                      link.string(),
                      "cannot be made a link to " + target.string() + " (" +
                          error.message() + ")",
                      "choose an --output_path on a disk that knows symbolic "
                      "links");
  }
  RenameFile(temporary, link);
}

void LinkMap(OriginalState state,
             const std::filesystem::path& original,
             const std::filesystem::path& link) {
  if (state != OriginalState::kMissing) {
    ReplaceByLink(original, link);
    return;
  }
  std::error_code error;
  std::filesystem::remove(link, error);
}

void RequireFoldersInside(const std::filesystem::path& root) {
  std::error_code error;
  const std::filesystem::path inside = std::filesystem::canonical(root, error);
  const auto require_inside = [&](const std::filesystem::path& folder) {
    const std::filesystem::path target =
        std::filesystem::canonical(folder, error);
    const auto [end, rest] = std::mismatch(
        inside.begin(), inside.end(), target.begin(), target.end());
    if (error || end != inside.end()) {
      throw Error::File(
          ErrorCode::kUnsupported,
          folder.string(),
          "is a link that leads out of the workspace, to " + target.string(),
          "put a folder in its place, or refine with "
          "--output_path");
    }
  };
  const std::filesystem::path stereo = root / "stereo";
  if (std::filesystem::is_symlink(stereo, error)) {
    require_inside(stereo);
  }
  const bool is_output = ReadOutputMarker(root).has_value();
  for (std::filesystem::recursive_directory_iterator it(stereo, error), end;
       !error && it != end;
       it.increment(error)) {
    std::error_code ignored;
    if (!it->is_symlink(ignored) || !it->is_directory(ignored)) {
      continue;
    }
    const std::filesystem::path name = it->path().lexically_relative(stereo);
    if (name != "consistency_graphs" && !(is_output && name == "cost_maps")) {
      require_inside(it->path());
    }
  }
}

}  // namespace tsar
