// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/fusion/fusion_options.h"
#include "colmap_tsar/fusion/fusion_pixel.h"

#include <cstdint>
#include <vector>

namespace tsar {

// An image whose pixels are fused, in the memory of a device.
struct FusionInput {
  Camera camera;  // At the size of the pixels.
  ImageView<const FusionPixel> pixels;
};

// Another image that is asked about them.
struct FusionSourceInput {
  FusionInput view;
  // Whether what both see may be left to it: its pixels become points, and it
  // asks this image in turn.
  bool may_own = true;
  // Its place in the order of all images, by which one of two equal pixels is
  // chosen.
  int place = 0;
};

struct FusedPoint {
  Vec3f position;  // In the frame of the image's camera.
  Vec3f normal;    // The same; a unit vector, or zero where none is known.
  Rgb color;
  // Its pixel.
  int column = -1;  // Below 0: there is no point.
  int row = -1;
  // Bit i: source i agrees. The image itself always does.
  uint64_t sources = 0;
};

// The points that the pixels of one image become: of each square of
// point_spacing pixels the one in the middle.
//
// A source agrees on a pixel where the depth that it has there is about that of
// the pixel's point, its own point leads back to about the pixel, and the
// normals are alike, as far as they are known. It sees through the point where
// its depth is larger by four times the largest error.
//
// A surface that several images see becomes points of the one whose pixels
// cover least of it (depth / focal length), in steps of a factor of 1.5, and of
// the first one among those in the same step. By the exact size, of views that
// are about equally far away always the depth that errs most towards its camera
// would be chosen.
//
// The point lies on the ray of the pixel. The depth that a source gives it is
// where the ray meets the plane through the source's point with its normal.
//
// place: of the image, see FusionSourceInput. Sources: at most
// kMaxFusionSources. Bits do not depend on the device or the number of threads.
std::vector<FusedPoint> FuseView(const FusionInput& view,
                                 int place,
                                 const std::vector<FusionSourceInput>& sources,
                                 const FusionOptions& options,
                                 Device& device);

// The bytes of the device's memory that this takes beside the images.
int64_t FuseViewWorkingBytes(int width,
                             int height,
                             const FusionOptions& options);

}  // namespace tsar
