// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/fusion/fusion_pixel.h"
#include "colmap_tsar/run/store/workspace.h"

#include <vector>

namespace tsar {

// An image with its maps, ready to be fused.
struct FusionView {
  Camera camera;  // At the size of the pixels, which is that of the maps.
  Image<FusionPixel> pixels;
};

// The maps of an image as they are in the workspace now, without what is
// masked. sources: images that see the same, in the sparse model; by their
// distances it is told how precise depths are whose sigma is not known. Depths
// without a confidence map are certain. Errors as ReadImageMaps() and
// Workspace::ReadImage().
FusionView LoadFusionView(const Workspace& workspace,
                          int image,
                          const std::vector<int>& sources);

}  // namespace tsar
