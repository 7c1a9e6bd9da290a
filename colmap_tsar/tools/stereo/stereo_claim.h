// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <vector>

namespace tsar {

// stereo/tsar_stereo: what MatchWorkspace keeps between the passes and from run
// to run.
ContainedPath GetStereoFolder(const Workspace& workspace);

// Sees to it that all maps there are of the images to match are those that a
// run with these options on these inputs makes, of which a former run may have
// done a part. overwrite: whether others may be removed. is_listed: by place in
// Problems(), whether the run makes the image's maps. Throws Error
// kUnsupported, before a file is changed, where there are others and overwrite
// is false or their image is not listed, or where the workspace has been
// refined; and what StereoDepths, removing and writing throw.
void ClaimMaps(const Workspace& workspace,
               const StereoOptions& options,
               bool overwrite,
               const std::vector<bool>& is_listed);

}  // namespace tsar
