// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/compose/photometric_offset.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/view_data.h"

#include <memory>
#include <vector>

namespace tsar {

// Restores relief below the standard deviation of measured depths, which
// composition flattens: posters, doors and moldings. Measured pixels with
// texture move by the mean offset that the images show in their neighborhood;
// normals and provenance stay. The map must have been judged at its full size.
void RestoreDetail(
    const DeviceReference& reference,
    const std::vector<std::shared_ptr<const UploadedView>>& sources,
    const DepthResolution& resolution,
    ComposedMap* composed,
    Device& device);

}  // namespace tsar
