// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>

#include "benchmarks/scene/room.h"

namespace tsar {

// A photo of the room with the exact depth (z) and normal (camera frame) of
// every pixel's middle.
struct RenderedView {
  Camera camera;
  Image<Rgb> color;
  Image<float> depth;
  Image<Vec3f> normal;
};

// noise_key: the same key and camera give the same sensor noise.
RenderedView RenderView(const Room& room,
                        const Camera& camera,
                        uint32_t noise_key,
                        ThreadPool& threads);

// Maps with the typical errors of those that patch_match_stereo writes.
struct SimulatedMaps {
  // Dense: noise and some outliers where the image has texture, smooth and
  // wrong surfaces where it has none.
  DepthNormal photometric;
  // What the filter leaves: most of the first, little of the second.
  DepthNormal geometric;
};

// noise_key: differs between the views, so that their errors do not agree.
SimulatedMaps SimulateStereoMaps(const RenderedView& view,
                                 uint32_t noise_key,
                                 ThreadPool& threads);

}  // namespace tsar
