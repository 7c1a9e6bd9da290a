// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// Whose depth it is that a patch measured. Matching finds the depth of what
// varies in the patch. Where that is an edge at the patch's rim and the pixel
// itself lies on something flat, the pixel got the depth of the edge: a wall
// beside a picture frame takes the frame's.

// The share of a patch's pattern that is the pixel's own, from 0 to 1: that of
// the contrast of the whole patch which is found close to the pixel, less where
// the patch reaches into superpixels with more texture than the pixel's own,
// since an edge belongs to the side that has the texture. 1 from half of the
// contrast on, and where nothing varies in the patch.
// gray: grey levels (0-255); contrast: ComputeContrast() of them; superpixels:
// labels in [0, num_superpixels); patch_radius: of the matching patches, in
// pixels of these images.
Image<float> ComputeOwnTexture(const Image<float>& gray,
                               const Image<float>& contrast,
                               const Image<int>& superpixels,
                               int num_superpixels,
                               int patch_radius);

}  // namespace tsar
