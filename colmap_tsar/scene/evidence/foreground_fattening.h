// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>

namespace tsar {

// Whose depth it is that a patch measured. Matching finds the depth of what
// varies in the patch. Where that is an edge at the patch's rim and the pixel
// itself lies on something flat, the pixel got the depth of the edge: a wall
// beside a picture frame takes the frame's.

// The share of a patch's pattern that is the pixel's own, from 0 to 1: twice
// the share of the contrast of the whole patch that is found close to the
// pixel. Less where the patch reaches into superpixels with more than twice the
// texture of the pixel's own, since an edge belongs to the side that has the
// texture: times twice the share of that texture which its own one has. 1 where
// nothing varies in the patch.
// gray: grey levels (0-255); contrast: ComputeContrast() of them; superpixels:
// labels in [0, num_superpixels); patch_radius: of the matching patches, in
// pixels of these images; one below 2 counts as 2.
Image<float> ComputeFatteningWeight(const Image<float>& gray,
                                    const Image<float>& contrast,
                                    const Image<int>& superpixels,
                                    int num_superpixels,
                                    int patch_radius);

}  // namespace tsar
