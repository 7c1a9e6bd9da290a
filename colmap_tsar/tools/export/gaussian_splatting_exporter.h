// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <memory>

namespace tsar {

// The inverse depth that a level of 65536 would stand for, which is one for all
// images: the trainer leaves out images whose scale is more than five times off
// the median of all. It is that of the nearest depth, but of none nearer than a
// sixteenth of the median depth, so that single pixels near the camera do not
// take the steps that all others need. depth: of all images.
double InverseDepthScale(const DepthStatistics& depth);

// What the trainer of 3D Gaussian splatting (graphdeco-inria) reads from a
// folder of COLMAP's: images/, the sparse model in sparse/0, inverse depths of
// 16 bits in depths/STEM.png and sparse/0/depth_params.json, by which
// level / 65536 * scale + offset is the inverse depth. An image without depth
// gets zeros and the scale 0, which the trainer leaves out. Pixels without
// depth are 0; it knows no mask for these, so depth_masks/STEM.png (255: depth)
// is for others. Nearer depths than 1 / scale become the nearest level.
// workspace must outlive the exporter. Throws what RequireUtf8Names() and
// UniqueStems() throw.
std::unique_ptr<ImageExporter> MakeGaussianSplattingExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const DepthStatistics& depth);

}  // namespace tsar
