// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <cstddef>
#include <vector>

namespace tsar {

// For each pass, the indices in Problems() of the images to match in it, so
// that the last pass makes the listed maps as in a run on all images: every
// other pass includes the sources of the images of the next one.
std::vector<std::vector<size_t>> FindImagesOfPasses(
    const Workspace& workspace,
    const StereoOptions& options,
    int num_passes,
    const std::vector<bool>& is_listed);

}  // namespace tsar
