// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/originals.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <system_error>

#include <unistd.h>

namespace tsar {
namespace {

Error Refused(const std::filesystem::path& output, const std::string& what) {
  return Error::File(ErrorCode::kUnsupported,
                     output.string(),
                     what,
                     "choose another " + OptionName("output_path"));
}

bool IsLink(const std::filesystem::path& path) {
  return std::filesystem::is_symlink(SymlinkStatus(path));
}

// The link to the images tells whose output a workspace is; it is made first.
bool IsOutputOf(const std::filesystem::path& input,
                const std::filesystem::path& output) {
  std::error_code error;
  return IsLink(output / "images") &&
         std::filesystem::equivalent(
             input / "images", output / "images", error);
}

// Atomically makes `link` a symbolic link to the canonical path of `target`,
// replacing a file or link of that name. Creates the folder.
void ReplaceByLink(const std::filesystem::path& target,
                   const ContainedPath& link) {
  const auto refused = [&](const std::string& reason) {
    return Error::File(
        ErrorCode::kIo,
        link.string(),
        "cannot be made a link to " + target.string() + " (" + reason + ")",
        "choose an " + OptionName("output_path") +
            " on a disk that knows symbolic links");
  };
  std::error_code error;
  const std::filesystem::path canonical =
      std::filesystem::canonical(target, error);
  if (error) {
    throw refused(error.message());
  }
  if (std::filesystem::read_symlink(link.Path(), error) == canonical &&
      !error) {
    return;
  }
  CreateFolders(link.Parent());
  const ContainedPath temporary =
      link.Parent() / (link.Filename().string() + AtomicFile::kTemporarySuffix);
  RequireNoFolder(temporary.Path());
  RemoveFile(temporary);
  std::filesystem::create_symlink(canonical, temporary.Path(), error);
  if (error) {
    throw refused(error.message());
  }
  RenameFile(temporary, link);
}

// own: the original that the output has.
void LinkMap(const OriginalMap& original,
             const OriginalMap& own,
             const ContainedPath& map) {
  if (original.path.empty()) {
    if (IsLink(map)) {
      RemoveFile(map);
    }
    return;
  }
  if (!own.path.empty() && AreSameFile(original.path, own.path)) {
    return;
  }
  if (own.state != MapState::kMissing && own.state != MapState::kRefined &&
      !IsLink(map)) {
    Supersede(map, map);
  }
  ReplaceByLink(original.path, map);
}

void LinkMaps(const Workspace& input, const std::filesystem::path& output) {
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    CreateFolders({output, std::filesystem::path("stereo") / folder});
  }
  for (int image = 0; image < input.NumImages(); ++image) {
    for (const MapType type : kMapTypes) {
      const MapPaths from = input.Paths(image, type);
      const MapPaths to = GetMapPaths(output, input.Name(image), type);
      const OriginalMaps originals = FindOriginals(from);
      const OriginalMaps own =
          InspectOriginals(to, ReadRecordIfValid(to.record));
      LinkMap(originals.depth, own.depth, to.depth);
      LinkMap(originals.normal, own.normal, to.normal);
      if (Exists(from.cost)) {
        ReplaceByLink(from.cost, to.cost);
      } else if (IsLink(to.cost)) {
        RemoveFile(to.cost);
      }
    }
  }
}

void RequireUsable(const Workspace& input,
                   const std::filesystem::path& output) {
  std::error_code error;
  const std::filesystem::path root = std::filesystem::canonical(input.Root());
  const std::filesystem::path canonical =
      std::filesystem::weakly_canonical(output, error);
  if (error) {
    throw Refused(output, "not a usable path (" + error.message() + ")");
  }
  if (canonical == root) {
    throw Refused(output, "the output is the input workspace itself");
  }
  RequireOutsideInputs(root, output, OptionName("output_path"));
  if (IsWithin(root, canonical)) {
    throw Refused(output, "the output is a folder around the input");
  }
  if (!Exists(output) || IsOutputOf(root, output)) {
    return;
  }
  if (!std::filesystem::is_directory(output)) {
    throw Refused(output, "there is a file of this name");
  }
  // A killed call may have left the temporary name of its first link.
  if (!std::ranges::all_of(
          ListFolder({output, {}}), [](const FolderEntry& entry) {
            return entry.is_link &&
                   entry.path.string().ends_with(AtomicFile::kTemporarySuffix);
          })) {
    throw Refused(
        output,
        "the folder is not empty and not an output workspace of this input");
  }
}

}  // namespace

void BeginOutputWorkspace(const Workspace& input,
                          const std::filesystem::path& output) {
  RequireUsable(input, output);
  ReplaceByLink(input.Root() / "images", {output, "images"});
  CreateFolders({output, "stereo"});
}

Workspace CreateOutputWorkspace(const Workspace& input,
                                const std::filesystem::path& output) {
  BeginOutputWorkspace(input, output);
  const std::filesystem::path& root = input.Root();
  const ContainedPath stereo(output, "stereo");
  // COLMAP looks for the model in `sparse` itself.
  ReplaceByLink(input.ModelFolder(), {output, "sparse"});
  if (std::filesystem::is_directory(root / "stereo" / "consistency_graphs")) {
    ReplaceByLink(root / "stereo" / "consistency_graphs",
                  stereo / "consistency_graphs");
  }
  for (const char* name : {"patch-match.cfg", "fusion.cfg"}) {
    if (Exists(root / "stereo" / name)) {
      CopyFile(root / "stereo" / name, stereo / name);
    }
  }
  LinkMaps(input, output);
  Workspace workspace = input;
  workspace.MoveTo(output);
  return workspace;
}

}  // namespace tsar
