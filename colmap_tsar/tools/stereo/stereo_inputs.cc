// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/store/originals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// What every map of the workspace depends on: of each image its camera, photo
// and mask and, of references, their sources and depths. An unused one is "-".
enum Input { kCamera, kPhoto, kMask, kSources, kDepths, kNumInputs };

// By Input, in the order of a line, which ends in the image's name.
using InputState = std::array<std::string, kNumInputs>;

constexpr std::array<const char*, kNumInputs> kInputNames = {
    "its camera",
    "its photo",
    "its mask",
    "its list of sources",
    "the range of its sparse points"};

// The inputs by the names of reference and source images.
using StereoInputs = std::map<std::string, InputState>;

// The first image with another input, and a text for an error.
struct StereoChange {
  std::string image;
  std::string text;
};

// The first line of a file.
const std::string kHead =
    std::string("fingerprints of five inputs, ") + kContentHashName;

StereoInputs FindStereoInputs(const Workspace& workspace,
                              const StereoOptions& options) {
  StereoInputs inputs;
  const auto find = [&](int image) -> InputState& {
    const SparseModel::ModelImage& entry = workspace.Model().images[image];
    InputState& state = inputs[entry.name];
    if (state[kCamera].empty()) {
      state = {FingerprintOf(entry.camera),
               FingerprintOf(FileState(workspace.ImagePath(image))),
               workspace.HasMask(image)
                   ? FingerprintOf(FileState(workspace.MaskPath(image)))
                   : "-",
               "-",
               "-"};
    }
    return state;
  };
  for (const StereoProblem& problem : workspace.Problems()) {
    if (problem.sources.empty()) {
      continue;
    }
    const std::vector<int> sources = StereoSources(problem, options);
    std::ranges::for_each(sources, find);
    InputState& state = find(problem.reference);
    const DepthInterval depths =
        StereoDepths(workspace, problem.reference, options);
    TextStream names;
    for (const int source : sources) {
      // Names have no line breaks.
      names << workspace.Model().images[source].name << "\n";
    }
    TextStream range;
    range << std::hexfloat << depths.min << " " << depths.max;
    state[kSources] = FingerprintOf(names.str());
    state[kDepths] = FingerprintOf(range.str());
  }
  return inputs;
}

// Reads the inputs from a text file. Returns nullopt if there is none, it is
// incomplete, or has hashes of another kind.
std::optional<StereoInputs> ReadStereoInputs(
    const std::filesystem::path& path) {
  InputFile file(path);
  std::string line;
  if (!std::getline(file, line) || line != kHead) {
    return std::nullopt;
  }
  StereoInputs inputs;
  while (std::getline(file, line)) {
    InputState state;
    size_t begin = 0;
    for (std::string& input : state) {
      const size_t end = line.find(' ', begin);
      if (end == std::string::npos) {
        return std::nullopt;
      }
      input = line.substr(begin, end - begin);
      begin = end + 1;
    }
    inputs[line.substr(begin)] = std::move(state);
  }
  return inputs;
}

void WriteStereoInputs(const ContainedPath& path, const StereoInputs& inputs) {
  AtomicFile file(path);
  file.Stream() << kHead << "\n";
  for (const auto& [name, state] : inputs) {
    for (const std::string& input : state) {
      file.Stream() << input << " ";
    }
    file.Stream() << name << "\n";
  }
  file.Commit();
}

// Compares the images of both; nullopt if none differs.
std::optional<StereoChange> FindStereoChange(const StereoInputs& before,
                                             const StereoInputs& now) {
  std::optional<StereoChange> first;
  int num_others = 0;
  for (const auto& [name, state] : now) {
    const auto found = before.find(name);
    if (found == before.end() || found->second == state) {
      continue;
    }
    if (first) {
      ++num_others;
      continue;
    }
    std::string changes;
    int num_changes = 0;
    for (size_t i = 0; i < state.size(); ++i) {
      if (found->second[i] != state[i]) {
        changes +=
            (num_changes++ > 0 ? " and " : "") + std::string(kInputNames[i]);
      }
    }
    first = {name,
             changes + (num_changes > 1 ? " have" : " has") +
                 " changed since the maps were made"};
  }
  if (num_others > 0) {
    first->text +=
        ", and " + std::to_string(num_others) +
        (num_others == 1 ? " other image has" : " other images have") +
        " changed, too";
  }
  return first;
}

// A map that would be removed; without a replacement, where it is not listed.
Error Foreign(const fs::path& path, bool is_listed) {
  return Error::File(
      ErrorCode::kUnsupported,
      path.string(),
      std::string("is of another program, or was made with other options") +
          (is_listed ? "" : ", and its image is not in the list"),
      (is_listed ? "give " + OptionName("overwrite") + " 1 to replace all maps"
                 : "leave " + OptionName("image_list_path") +
                       " out to replace all maps") +
          ", or work on a copy");
}

// Whether existing maps, perhaps replaced ones, have the sizes of the run's.
bool HaveRightSizes(const Workspace& workspace, const StereoOptions& options) {
  for (const StereoProblem& problem : workspace.Problems()) {
    const auto [width, height] =
        MapSizeOf(workspace.Model().images[problem.reference].camera,
                  options.max_image_size);
    for (const MapType type : kMapTypes) {
      const MapPaths paths = workspace.Paths(problem.reference, type);
      for (const fs::path& path : {paths.depth.Path(), paths.normal.Path()}) {
        try {
          if (fs::exists(path)) {
            const MapSize size = ReadMapSize(path);
            if (size.width != width || size.height != height) {
              return false;
            }
          }
        } catch (const Error&) {
          return false;  // The file is no map.
        }
      }
    }
  }
  return true;
}

}  // namespace

std::vector<int> StereoSources(const StereoProblem& problem,
                               const StereoOptions& options) {
  std::vector<int> sources = problem.sources;
  if (sources.size() > static_cast<size_t>(options.num_sources)) {
    sources.resize(static_cast<size_t>(options.num_sources));
  }
  return sources;
}

DepthInterval StereoDepths(const Workspace& workspace,
                           int image,
                           const StereoOptions& options) {
  if (options.depth_min > 0.0) {
    return {options.depth_min, options.depth_max};
  }
  const std::optional<DepthInterval> range =
      SparseDepthInterval(workspace.Model(), image);
  if (!range) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.ImagePath(image).string(),
        "sees none of the sparse points, so that its depths cannot be guessed",
        "give " + OptionName("depth_min") + " and " + OptionName("depth_max"));
  }
  return *range;
}

std::pair<int, int> MapSizeOf(const Camera& camera, int max_image_size) {
  const int side = std::max(camera.width, camera.height);
  const double scale = max_image_size > 0 && max_image_size < side
                           ? static_cast<double>(max_image_size) / side
                           : 1.0;
  return {std::max(1, static_cast<int>(std::lround(camera.width * scale))),
          std::max(1, static_cast<int>(std::lround(camera.height * scale)))};
}

ContainedPath GetStereoFolder(const Workspace& workspace) {
  return {workspace.Root(), fs::path("stereo") / "tsar_stereo"};
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

void ClaimMaps(const Workspace& workspace,
               const StereoOptions& options,
               bool overwrite,
               const std::vector<bool>& is_listed) {
  const ContainedPath options_path = GetStereoFolder(workspace) / "options.txt";
  const ContainedPath inputs_path = GetStereoFolder(workspace) / "inputs.txt";
  const StereoInputs inputs = FindStereoInputs(workspace, options);
  std::optional<StereoInputs> known;
  std::optional<StereoChange> change;
  InputFile options_file(options_path);
  const std::string known_options(
      (std::istreambuf_iterator<char>(options_file)), {});
  if (known_options == options.Text()) {
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
    for (const MapType type : kMapTypes) {
      if (goes_on && known->contains(image.name)) {
        continue;
      }
      const MapPaths paths = workspace.Paths(problem.reference, type);
      RequireUnrefined(paths);
      for (const ContainedPath& path :
           {paths.depth, paths.normal, paths.cost}) {
        if (fs::exists(path)) {
          foreign.push_back(path);
          if (overwrite && !is_listed[place]) {
            throw Foreign(path, /*is_listed=*/false);
          }
        }
      }
    }
  }
  if (!foreign.empty() && !overwrite) {
    if (!change) {
      throw Foreign(foreign.front(), /*is_listed=*/true);
    }
    throw Error::File(
        ErrorCode::kUnsupported,
        workspace.ImagePath(workspace.Model().IndexOf(change->image)).string(),
        change->text,
        "give " + OptionName("overwrite") +
            " 1 to make all maps anew, or work on a copy");
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
