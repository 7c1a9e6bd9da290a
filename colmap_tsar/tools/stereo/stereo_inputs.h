// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

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

// stereo/tsar_stereo, the state of MatchWorkspace between passes and runs.
ContainedPath GetStereoFolder(const Workspace& workspace);

// Throws Error kUnsupported if maps of an image have been refined, since what
// replaces them would be taken for refined, too.
void RequireUnrefined(const MapPaths& paths);

// Makes sure that all existing maps of the images to match are those of a run
// with these options and inputs, of which an earlier run may have completed a
// part, and that may have been refined since. overwrite: whether other maps may
// be removed. is_listed: by index in Problems(), whether the run makes the
// image's maps. Throws Error kUnsupported, before a file is changed, if there
// are other maps and overwrite is false, or their image is not listed, or they
// have been refined; and those of StereoDepths, removing and writing.
void ClaimMaps(const Workspace& workspace,
               const StereoOptions& options,
               bool overwrite,
               const std::vector<bool>& is_listed);

}  // namespace tsar
