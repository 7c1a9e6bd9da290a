// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/links.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/store/output_workspace.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <unistd.h>

namespace tsar {
namespace {

Error NotLinked(const ContainedPath& link,
                const std::filesystem::path& target,
                const std::string& reason) {
  return Error::File(
      ErrorCode::kIo,
      link.string(),
      "cannot be made a link to " + target.string() + " (" + reason + ")",
      "choose an " + OptionName("output_path") +
          " on a disk that knows symbolic "
          "links");
}

}  // namespace

void ReplaceByLink(const std::filesystem::path& target,
                   const ContainedPath& link) {
  std::error_code error;
  const std::filesystem::path canonical =
      std::filesystem::canonical(target, error);
  if (error) {
    throw NotLinked(link, target, error.message());
  }
  if (std::filesystem::read_symlink(link, error) == canonical && !error) {
    return;
  }
  const Folder folder = Folder::Create(link.Parent());
  const std::string temporary =
      link.Filename().string() + AtomicFile::kTemporarySuffix;
  unlinkat(folder.Descriptor(), temporary.c_str(), 0);
  RequireNoFolder((link.Parent() / temporary).Path());
  if (symlinkat(canonical.c_str(), folder.Descriptor(), temporary.c_str()) !=
      0) {
    throw NotLinked(link, target, std::strerror(errno));
  }
  RenameFile(link.Parent() / temporary, link);
}

void LinkMap(const OriginalMap& original, const ContainedPath& link) {
  if (original.state != OriginalState::kMissing) {
    ReplaceByLink(original.path, link);
  } else {
    RemoveFile(link);
  }
}

void RequireFoldersInside(const std::filesystem::path& root) {
  const ContainedPath stereo(root, "stereo");
  const bool is_output = ReadOutputMarker(root).has_value();
  for (const TreeEntry& entry : ListTree(stereo)) {
    std::error_code error;
    if (!entry.is_link ||
        !std::filesystem::is_directory(entry.path.Path(), error)) {
      continue;
    }
    const std::filesystem::path name =
        entry.path.Path().lexically_relative(stereo.Path());
    if (name != "consistency_graphs" && !(is_output && name == "cost_maps")) {
      Folder::OpenIfThere(entry.path);  // Throws where it leads out.
    }
    // Files stored there must not be those stored elsewhere.
    const std::string first = name.begin()->string();
    if (first == "tsar") {
      throw Error::File(ErrorCode::kUnsupported,
                        entry.path.string(),
                        "is a link to a folder among those of this program",
                        "put a folder in its place");
    }
  }
}

}  // namespace tsar
