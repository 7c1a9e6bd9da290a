// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <memory>

namespace tsar {

// The inverse depth of a level of 65536, common to all images: the trainer
// drops images whose scale differs from the median by more than a factor of
// five. It is that of the nearest depth or of a sixteenth of the median depth,
// whichever is farther, so that single near pixels do not coarsen the levels of
// all others. depth: statistics of all images.
double InverseDepthScale(const DepthStatistics& depth);

// Exporter for the trainer of 3D Gaussian splatting (graphdeco-inria), which
// reads a COLMAP folder: images/, the sparse model in sparse/0, inverse depths
// of 16 bits in depths/STEM.png and sparse/0/depth_params.json, with inverse
// depth = level / 65536 * scale + offset. An image without depth gets zeros and
// the scale 0, which the trainer skips. Pixels without depth are 0; the trainer
// has no mask for these, so depth_masks/STEM.png (255: depth) is for other
// programs. Depths nearer than 1 / scale become the largest level. workspace
// must outlive the exporter. Throws the errors of RequireUtf8Names() and
// UniqueStems().
std::unique_ptr<ImageExporter> MakeGaussianSplattingExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const DepthStatistics& depth);

}  // namespace tsar
