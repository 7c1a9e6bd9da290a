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

// The maps of an image as they are in the workspace now or, with originals, as
// they were before refinement; without masked pixels. sources: images of the
// same scene, by index in the sparse model; their baselines give the precision
// of depths without a sigma. Depths without a confidence map have full
// confidence. Errors as ReadImageMaps(), ReadOriginalImageMaps() and
// Workspace::ReadImage().
FusionView LoadFusionView(const Workspace& workspace,
                          int image,
                          const std::vector<int>& sources,
                          bool originals = false);

}  // namespace tsar
