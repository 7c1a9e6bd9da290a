// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <memory>

namespace tsar {

// Exporter for nerfstudio: transforms.json with all images of the sparse model,
// these in images/, and their depth in depths/, as arrays in thousandths of a
// unit of the sparse model: nerfstudio interprets stored depths as millimeters.
// An image without maps gets an array of zeros, since nerfstudio requires depth
// for all images or none; 0 is no depth. The cameras are those of the images,
// with the frame of OpenGL, and the world is that of the sparse model.
// workspace must outlive the exporter. Throws the errors of RequireUtf8Names().
std::unique_ptr<ImageExporter> MakeNerfstudioExporter(
    const Workspace& workspace, const ContainedPath& folder);

}  // namespace tsar
