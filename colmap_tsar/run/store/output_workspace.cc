// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/run/store/links.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr const char* kMarkerName = "output_of.json";

Error Refused(const std::filesystem::path& output, const std::string& what) {
  return Error::File(ErrorCode::kUnsupported,
                     output.string(),
                     what,
                     "choose another " + OptionName("output_path"));
}

// `input` is canonical.
void RequireOutside(const std::filesystem::path& input,
                    const std::filesystem::path& output) {
  std::error_code error;
  const std::filesystem::path canonical =
      std::filesystem::weakly_canonical(output, error);
  if (error) {
    throw Refused(output, "not a usable path (" + error.message() + ")");
  }
  if (canonical == input) {
    throw Refused(output, "the output is the input workspace itself");
  }
  const std::string folder = FindInputFolder(input, output);
  if (!folder.empty()) {
    throw Refused(output, "the output is in the input's folder " + folder);
  }
  if (IsWithin(input, canonical)) {
    throw Refused(output, "the output is a folder around the input");
  }
}

// Whether it is empty or holds only the files of a call that was killed before
// it had written the marker.
bool IsEmptyOrBegun(const std::filesystem::path& output) {
  const ContainedPath marker =
      GetTsarFolder(output) /
      (std::string(kMarkerName) + AtomicFile::kTemporarySuffix);
  return std::ranges::all_of(
      ListTree({output, {}}), [&](const TreeEntry& entry) {
        return IsWithin(marker.Path(), entry.path.Path());
      });
}

void RequireEmptyOrOutputOf(const std::filesystem::path& input,
                            const std::filesystem::path& output) {
  if (!Exists(output)) {
    return;
  }
  if (!std::filesystem::is_directory(output)) {
    throw Refused(output, "there is a file of this name");
  }
  const auto marked = ReadOutputMarker(output);
  if (marked && *marked != input) {
    throw Refused(output, "it is the output for " + marked->string());
  }
  if (!marked && !IsEmptyOrBegun(output)) {
    throw Refused(output,
                  "the folder is not empty and not an output workspace");
  }
}

void WriteMarker(const std::filesystem::path& input,
                 const std::filesystem::path& output) {
  WriteJson(GetTsarFolder(output) / kMarkerName,
            {{"version", TSAR_VERSION}, {"input", input.string()}});
}

// Reads a path from a JSON file; nothing where there is no such file.
std::optional<std::filesystem::path> ReadPath(const std::filesystem::path& path,
                                              const char* key,
                                              const Error& corrupt) {
  InputFile file(path);
  if (file.IsMissing()) {
    return std::nullopt;
  }
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + file.Reason() + ")",
                      "check what stands there and that you may read it");
  }
  try {
    return nlohmann::json::parse(file).at(key).get<std::string>();
  } catch (const nlohmann::json::exception&) {
    throw corrupt;
  }
}

ContainedPath OutputsFolder(const std::filesystem::path& input) {
  return GetTsarFolder(input) / kOutputsFolder;
}

void NoteOutput(const std::filesystem::path& input,
                const std::filesystem::path& output) {
  const std::string path = std::filesystem::canonical(output).string();
  ContentHash hash;
  hash.Update(path.data(), path.size());
  try {
    WriteJson(OutputsFolder(input) / (std::to_string(hash.Value()) + ".json"),
              {{"output", path}});
  } catch (const Error&) {
    // A program that cannot write there cannot restore it, either.
  }
}

// Returns whether any link was renewed. `input` is canonical.
bool RelinkOutput(const std::filesystem::path& input,
                  const std::filesystem::path& output) {
  const std::filesystem::path stored = GetTsarFolder(input) / "original";
  bool has_changed = false;
  for (const char* kind : {"depth_maps", "normal_maps"}) {
    const ContainedPath folder(output, std::filesystem::path("stereo") / kind);
    for (const TreeEntry& entry : ListTree(folder)) {
      std::error_code error;
      if (!entry.is_link || std::filesystem::exists(entry.path.Path(), error)) {
        continue;
      }
      const std::filesystem::path target =
          std::filesystem::read_symlink(entry.path.Path(), error);
      const std::filesystem::path name =
          entry.path.Path().lexically_relative(folder.Path());
      const std::filesystem::path original = input / "stereo" / kind / name;
      if (IsWithin(target, stored) &&
          std::filesystem::exists(original, error)) {
        ReplaceByLink(original, entry.path);
        has_changed = true;
      }
    }
  }
  return has_changed;
}

// Links to the original, unless the map has been refined there.
void LinkUnlessRefined(const OriginalMap& original, const ContainedPath& map) {
  const auto status = std::filesystem::symlink_status(map.Path());
  if (!std::filesystem::is_regular_file(status)) {
    LinkMap(original, map);
  }
}

// Returns whether links lead to stored originals, which may be put back.
bool LinkMaps(const Workspace& input, const std::filesystem::path& output) {
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    CreateFolders({output, std::filesystem::path("stereo") / folder});
  }
  bool has_stored = false;
  for (int image = 0; image < input.NumImages(); ++image) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const OriginalMaps originals =
          FindOriginals(input.SourcePaths(image, type));
      const MapPaths paths = GetMapPaths(output, input.Name(image), type);
      LinkUnlessRefined(originals.depth, paths.depth);
      LinkUnlessRefined(originals.normal, paths.normal);
      has_stored = has_stored ||
                   originals.depth.state == OriginalState::kStored ||
                   originals.normal.state == OriginalState::kStored;
    }
  }
  return has_stored;
}

}  // namespace

Workspace CreateOutputWorkspace(const Workspace& input,
                                const std::filesystem::path& output,
                                MapType type) {
  const std::filesystem::path source =
      std::filesystem::canonical(input.SourceRoot());
  RequireOutside(std::filesystem::canonical(input.Root()), output);
  RequireOutside(source, output);
  RequireEmptyOrOutputOf(source, output);
  // The marker comes first, so that an interrupted call can be resumed.
  WriteMarker(source, output);
  const ContainedPath stereo(output, "stereo");
  ReplaceByLink(source / "images", {output, "images"});
  // COLMAP looks for the model in `sparse` itself.
  ReplaceByLink(FindModelFolder(source), {output, "sparse"});
  for (const char* folder : {"consistency_graphs", "cost_maps"}) {
    if (std::filesystem::is_directory(source / "stereo" / folder)) {
      ReplaceByLink(source / "stereo" / folder, stereo / folder);
    }
  }
  for (const char* name : {"patch-match.cfg", "fusion.cfg"}) {
    if (Exists(source / "stereo" / name)) {
      CopyFile(source / "stereo" / name, stereo / name);
    }
  }
  if (LinkMaps(input, output)) {
    NoteOutput(source, output);
  }
  return Workspace(output, type);
}

std::vector<std::filesystem::path> RelinkOutputs(
    const std::filesystem::path& input, bool* all_done) {
  std::vector<std::filesystem::path> relinked;
  const std::filesystem::path canonical = std::filesystem::canonical(input);
  for (const TreeEntry& note : ListTree(OutputsFolder(input))) {
    try {
      const auto output = ReadPath(
          note.path,
          "output",
          Error::File(
              ErrorCode::kCorrupt,
              note.path.string(),
              "does not name an output workspace",
              "make links there again by running tsar_refine with its " +
                  OptionName("output_path")));
      if (!output || ReadOutputMarker(*output) != canonical) {
        continue;  // Moved, deleted, or not one of this input.
      }
      const WorkspaceLock lock(*output);
      if (RelinkOutput(canonical, *output)) {
        relinked.push_back(*output);
      }
    } catch (const Error& error) {
      // The input is complete nevertheless.
      *all_done = false;
      Warn(std::string("links of an output workspace were not made again: ") +
           error.what());
    }
  }
  return relinked;
}

std::optional<std::filesystem::path> ReadOutputMarker(
    const std::filesystem::path& root) {
  const ContainedPath path = GetTsarFolder(root) / kMarkerName;
  return ReadPath(
      path,
      "input",
      Error::File(ErrorCode::kCorrupt,
                  path.string(),
                  "does not name the input of this output workspace",
                  "delete the output workspace and make it again"));
}

}  // namespace tsar
