// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/export_format.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <memory>

namespace tsar {

// Exporter of all maps of each image in the formats kNpy, kExr and kPng16: in a
// folder for each kind of map, named by the image with its extension.
// depth_scale: units of the sparse model per step of a depth in 16 bits; depths
// that do not round to 1 to 65535 steps are left out. Sigmas have steps of a
// hundredth of that and are clamped to the largest. workspace must outlive the
// exporter. Errors as RequireExr().
std::unique_ptr<ImageExporter> MakeMapExporter(const Workspace& workspace,
                                               const ContainedPath& folder,
                                               ExportFormat format,
                                               double depth_scale);

}  // namespace tsar
