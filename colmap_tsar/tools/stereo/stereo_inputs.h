// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// The sources with which an image is matched.
std::vector<int> StereoSources(const StereoProblem& problem,
                               const StereoOptions& options);

// The depth range by options or sparse points; throws kNotFound without them.
DepthInterval StereoDepths(const Workspace& workspace,
                           int image,
                           const StereoOptions& options);

// Width and height of an image's maps. max_image_size: see StereoOptions.
std::pair<int, int> MapSizeOf(const Camera& camera, int max_image_size);

// The inputs by the names of reference and source images: "camera", "photo",
// "mask" and, for references, "sources", "depths" and "prior". Over the passes,
// every map depends on all of them.
using StereoInputs = std::map<std::string, InputState>;

// Throws the errors of StereoDepths.
StereoInputs FindStereoInputs(const Workspace& workspace,
                              const StereoOptions& options);

// Reads the inputs from a text file. Returns nullopt if there is none, it is
// incomplete, or has hashes of another kind.
std::optional<StereoInputs> ReadStereoInputs(const std::filesystem::path& path);
void WriteStereoInputs(const ContainedPath& path, const StereoInputs& inputs);

// The first image of both that differs, the input that differs, and the number
// of other such images, for an error; nullopt if none differs.
struct StereoChange {
  std::string image;
  std::string text;
};
std::optional<StereoChange> FindStereoChange(const StereoInputs& before,
                                             const StereoInputs& now);

}  // namespace tsar
