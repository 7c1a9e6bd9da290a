// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/export/export_format.h"
#include "colmap_tsar/export/image_exporter.h"
#include "colmap_tsar/store/workspace.h"

#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {

// What an export's manifest.json holds (docs/export.md): conventions, maps as
// the exporter describes them, and each image with its camera, of the size of
// its maps, its pose and its files.
nlohmann::ordered_json MakeExportManifest(
    const Workspace& workspace,
    ExportFormat format,
    const nlohmann::ordered_json& maps,
    const std::vector<int>& images,
    const std::vector<ExportedImage>& exported);

}  // namespace tsar
