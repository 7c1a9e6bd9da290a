// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/output_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/links.h"
#include "colmap_tsar/workspace/originals.h"
#include "colmap_tsar/workspace/record.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr const char* kMarkerName = "output_of.json";

Error Refused(const std::filesystem::path& output, const std::string& what) {
  return Error::File(ErrorCode::kUnsupported,
                     output.string(),
                     what,
                     "choose another --output_path");
}

bool Contains(const std::filesystem::path& folder,
              const std::filesystem::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end())
             .first == folder.end();
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
  for (const char* folder : {"images", "sparse", "stereo"}) {
    if (Contains(std::filesystem::canonical(input / folder), canonical)) {
      throw Refused(
          output, std::string("the output is in the input's folder ") + folder);
    }
  }
  if (Contains(canonical, input)) {
    throw Refused(output, "the output is a folder around the input");
  }
}

void RequireEmptyOrOutputOf(const std::filesystem::path& input,
                            const std::filesystem::path& output) {
  if (!std::filesystem::exists(output)) {
    return;
  }
  if (!std::filesystem::is_directory(output)) {
    throw Refused(output, "there is a file of this name");
  }
  const auto marked = ReadOutputMarker(output);
  if (marked && *marked != input) {
    throw Refused(output, "it is the output for " + marked->string());
  }
  if (!marked && !std::filesystem::is_empty(output)) {
    throw Refused(output,
                  "the folder is not empty and not an output workspace");
  }
}

void WriteMarker(const std::filesystem::path& input,
                 const std::filesystem::path& output) {
  const nlohmann::json json = {{"version", TSAR_VERSION},
                               {"input", input.string()}};
  CreateFolders(GetTsarFolder(output));
  AtomicFile file(GetTsarFolder(output) / kMarkerName);
  file.Stream() << json.dump(
                       2, ' ', false, nlohmann::json::error_handler_t::replace)
                << "\n";
  file.Commit();
}

// Links to the original, unless the map has been refined there.
void LinkUnlessRefined(OriginalState state,
                       const std::filesystem::path& original,
                       const std::filesystem::path& map) {
  const auto status = std::filesystem::symlink_status(map);
  if (!std::filesystem::is_regular_file(status)) {
    LinkMap(state, original, map);
  }
}

void LinkMaps(const Workspace& input, const std::filesystem::path& output) {
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    CreateFolders(output / "stereo" / folder);
  }
  const int num_images = static_cast<int>(input.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    const std::string& name =
        input.Model().images[static_cast<size_t>(image)].name;
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const OriginalMaps originals =
          FindOriginals(input.SourcePaths(image, type));
      const MapPaths paths = GetMapPaths(output, name, type);
      LinkUnlessRefined(originals.depth_state, originals.depth, paths.depth);
      LinkUnlessRefined(originals.normal_state, originals.normal, paths.normal);
    }
  }
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
  // First, so that an interrupted call can be taken up again.
  WriteMarker(source, output);
  for (const char* folder : {"images", "sparse"}) {
    ReplaceByLink(source / folder, output / folder);
  }
  for (const char* folder : {"consistency_graphs", "cost_maps"}) {
    if (std::filesystem::is_directory(source / "stereo" / folder)) {
      ReplaceByLink(source / "stereo" / folder, output / "stereo" / folder);
    }
  }
  for (const char* name : {"patch-match.cfg", "fusion.cfg"}) {
    if (std::filesystem::exists(source / "stereo" / name)) {
      CopyFile(source / "stereo" / name, output / "stereo" / name);
    }
  }
  LinkMaps(input, output);
  return Workspace(output, type);
}

std::optional<std::filesystem::path> ReadOutputMarker(
    const std::filesystem::path& root) {
  const std::filesystem::path path = GetTsarFolder(root) / kMarkerName;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::nullopt;
  }
  std::ifstream file(path);
  try {
    return nlohmann::json::parse(file).at("input").get<std::string>();
  } catch (const nlohmann::json::exception&) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "does not name the input of this output workspace",
                      "delete the output workspace and make it again");
  }
}

}  // namespace tsar
