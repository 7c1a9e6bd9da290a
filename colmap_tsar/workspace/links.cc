// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/links.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"

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

}  // namespace tsar
