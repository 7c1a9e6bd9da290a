// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_claim.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <iterator>
#include <optional>
#include <string>

namespace tsar {
namespace {

namespace fs = std::filesystem;

std::string ReadText(const fs::path& path) {
  InputFile file(path);
  return std::string(std::istreambuf_iterator<char>(file),
                     std::istreambuf_iterator<char>());
}

void RequireUnrefined(const MapPaths& paths) {
  if (fs::exists(paths.original_depth) || fs::exists(paths.original_normal)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        paths.depth.string(),
        "has been refined",
        "run tsar_refine with " + OptionName("restore") + " 1 first");
  }
  RequireNoStrayResults(paths);
}

Error Foreign(const fs::path& path) {
  return Error::File(ErrorCode::kUnsupported,
                     path.string(),
                     "is of another program, or was made with other options",
                     "give " + OptionName("overwrite") +
                         " 1 to replace all maps, or work on a copy");
}

// The error for a map that would be removed without a replacement.
Error NotListed(const fs::path& path) {
  return Error::File(ErrorCode::kUnsupported,
                     path.string(),
                     "is of another program, or was made with other options, "
                     "and its image is not in the list",
                     "leave " + OptionName("image_list_path") +
                         " out to replace all maps, or work on a copy");
}

Error Changed(const Workspace& workspace, const StereoChange& change) {
  return Error::File(
      ErrorCode::kUnsupported,
      workspace.ImagePath(workspace.Model().IndexOf(change.image)).string(),
      change.text,
      "give " + OptionName("overwrite") +
          " 1 to make all maps anew, or work on a copy");
}

bool HasSize(const fs::path& path, int width, int height) {
  try {
    const MapSize size = ReadMapSize(path);
    return size.width == width && size.height == height;
  } catch (const Error&) {
    return false;  // The file is no map.
  }
}

// Whether existing maps, perhaps replaced ones, have the sizes of the run's.
bool HaveRightSizes(const Workspace& workspace, const StereoOptions& options) {
  for (const StereoProblem& problem : workspace.Problems()) {
    const auto [width, height] =
        MapSizeOf(workspace.Model().images[problem.reference].camera,
                  options.max_image_size);
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const MapPaths paths = workspace.Paths(problem.reference, type);
      for (const fs::path& path : {paths.depth.Path(), paths.normal.Path()}) {
        if (fs::exists(path) && !HasSize(path, width, height)) {
          return false;
        }
      }
    }
  }
  return true;
}

}  // namespace

ContainedPath GetStereoFolder(const Workspace& workspace) {
  return {workspace.Root(), fs::path("stereo") / "tsar_stereo"};
}

void ClaimMaps(const Workspace& workspace,
               const StereoOptions& options,
               bool overwrite,
               const std::vector<bool>& is_listed) {
  const ContainedPath options_path = GetStereoFolder(workspace) / "options.txt";
  const ContainedPath inputs_path = GetStereoFolder(workspace) / "inputs.txt";
  const StereoInputs inputs = FindStereoInputs(workspace, options);
  std::optional<StereoInputs> known;
  std::optional<StereoChange> change;
  if (fs::exists(options_path) && ReadText(options_path) == options.Text()) {
    known = ReadStereoInputs(inputs_path);
    change = known ? FindStereoChange(*known, inputs) : std::nullopt;
  }
  const bool goes_on = known && !change && HaveRightSizes(workspace, options);
  // Everything is checked before the first file is removed.
  std::vector<ContainedPath> foreign;
  for (size_t place = 0; place < workspace.Problems().size(); ++place) {
    const StereoProblem& problem = workspace.Problems()[place];
    const SparseModel::ModelImage& image =
        workspace.Model().images[problem.reference];
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const MapPaths paths = workspace.Paths(problem.reference, type);
      RequireUnrefined(paths);
      if (goes_on && known->contains(image.name)) {
        continue;
      }
      for (const ContainedPath& path :
           {paths.depth, paths.normal, paths.cost}) {
        if (fs::exists(path)) {
          foreign.push_back(path);
          if (overwrite && !is_listed[place]) {
            throw NotListed(path);
          }
        }
      }
    }
  }
  if (!foreign.empty() && !overwrite) {
    throw change ? Changed(workspace, *change) : Foreign(foreign.front());
  }
  for (const ContainedPath& path : foreign) {
    RemoveFile(path);
  }
  if (goes_on) {
    // Maps of images that are no longer matched still exist, with their inputs.
    const size_t num_known = known->size();
    known->insert(inputs.begin(), inputs.end());
    if (known->size() > num_known) {
      WriteStereoInputs(inputs_path, *known);
    }
    return;
  }
  RemoveTree(GetStereoFolder(workspace));
  CreateFolders(GetStereoFolder(workspace));
  WriteStereoInputs(inputs_path, inputs);
  // The options file is written last: without it, the claim is invalid.
  AtomicFile file(options_path);
  file.Stream() << options.Text();
  file.Commit();
}

}  // namespace tsar
