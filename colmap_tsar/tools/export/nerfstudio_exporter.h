// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <filesystem>
#include <memory>

namespace tsar {

// Exporter for nerfstudio: transforms.json with all images of the sparse model,
// these in images/, their depth in depths/, as arrays in thousandths of a unit
// of the sparse model (nerfstudio interprets stored depths as millimeters), and
// their normals in normals/, as pictures of the size of the image: of red,
// green and blue, 127.5 + 127.5 n, with n in the frame of the sparse model's
// camera. An image without maps gets no depth and no normal anywhere, since
// nerfstudio requires depth for all images or none; depth 0 and normal
// (0, 0, 0) are none. The cameras are those of the images, with the frame of
// OpenGL, and the world is that of the sparse model. cloud: a PLY file in that
// world, which is copied for trainers to start from; empty: none.
//
// workspace must outlive the exporter. Throws Error kNotFound where the cloud
// has no points, and those of ReadPlyCloud() and RequireUtf8Names().
std::unique_ptr<ImageExporter> MakeNerfstudioExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const std::filesystem::path& cloud);

}  // namespace tsar
