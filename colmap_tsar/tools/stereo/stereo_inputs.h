// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/run/input_state.h"
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

// The depths to look for in an image. Throws kNotFound where neither the
// options nor sparse points tell.
DepthInterval StereoDepths(const Workspace& workspace,
                           int image,
                           const StereoOptions& options);

// Width and height of the maps that are made for an image. max_image_size: as
// in StereoOptions.
std::pair<int, int> MapSizeOf(const Camera& camera, int max_image_size);

// By the names of the images that are matched, or matched with, what is used of
// them: "camera", "photo", "mask" and, of the former, "sources" and "depths".
// Every map depends on all of them, over the passes.
using StereoInputs = std::map<std::string, InputState>;

// Throws what StereoDepths throws.
StereoInputs FindStereoInputs(const Workspace& workspace,
                              const StereoOptions& options);

// As a file of text. Nothing where there is no such file, it is not whole, or
// its fingerprints are not comparable with those of this version.
std::optional<StereoInputs> ReadStereoInputs(const std::filesystem::path& path);
void WriteStereoInputs(const ContainedPath& path, const StereoInputs& inputs);

// The first image that is in both and differs, what does, and how many other
// such images there are: for an error. Nothing where none differs.
struct StereoChange {
  std::string image;
  std::string text;
};
std::optional<StereoChange> FindStereoChange(const StereoInputs& before,
                                             const StereoInputs& now);

}  // namespace tsar
