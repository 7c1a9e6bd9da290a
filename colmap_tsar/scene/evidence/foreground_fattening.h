// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// Foreground fattening: matching finds the depth of the texture in a patch.
// Where that is an edge at the patch's border and the pixel itself lies on a
// textureless surface, the pixel gets the depth of the edge: a wall next to a
// picture frame gets the frame's.

// The share of a patch's texture that is the pixel's own, from 0 to 1: twice
// the ratio of the contrast close to the pixel to that of the whole patch.
// Where the patch reaches into superpixels with more than twice the texture of
// the pixel's own, it is multiplied by twice the ratio of its own texture to
// theirs, since an edge belongs to the side that has the texture. It is 1 where
// the patch has no contrast.
// gray: gray levels (0-255); contrast: ComputeContrast() of them; superpixels:
// labels in [0, num_superpixels); patch_radius: of the matching patches, in
// pixels of these images; one below 2 counts as 2.
Image<float> ComputeFatteningWeight(const Image<float>& gray,
                                    const Image<float>& contrast,
                                    const Image<int>& superpixels,
                                    int num_superpixels,
                                    int patch_radius);

}  // namespace tsar
