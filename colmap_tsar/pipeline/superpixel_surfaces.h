// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/pipeline/compose_scene.h"
#include "colmap_tsar/pipeline/find_scene.h"

#include <vector>

namespace tsar {

// What composition asks about the surfaces that were found in a view's
// superpixels. All results are of each superpixel, in the camera's frame.

// Invalid where it has none.
std::vector<Plane> PlanesOfSuperpixels(const LabeledView& labeled);

// Superpixels of curved surfaces get planes of their own, which touch the
// surface in their middle.
LabeledView FlattenSurfaces(const ObservedView& view,
                            LabeledView labeled,
                            const CurvedView& curved);

// With their confidences and errors.
std::vector<ComposedSuperpixel> RateSuperpixels(const FoundScene& found);

}  // namespace tsar
