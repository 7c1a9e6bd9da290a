// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
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

// A source image with which these pixels are compared.
struct FusionSourceInput {
  FusionInput view;
  // Whether a surface that both see may be assigned to it: its pixels become
  // points, and it uses this image as a source in turn.
  bool may_own = true;
  // Its index in the order of all images, which decides between two equal
  // pixels.
  int place = 0;
};

struct FusedPoint {
  Vec3f position;  // In the frame of the image's camera.
  Vec3f normal;    // In that frame; a unit vector, or zero where unknown.
  Rgb color;
  // The pixel of the point.
  int column = -1;  // Below 0: there is no point.
  int row = -1;
  // Bit i is set if source i agrees. The image itself always does.
  uint64_t sources = 0;
};

// Fuses the pixels of one image into points: the middle pixel of each square
// with a side of point_spacing pixels.
//
// A source agrees on a pixel if its depth there is about that of the pixel's
// point, its own point reprojects to about the pixel, and the normals are
// similar, as far as they are known. It sees through the point if its depth is
// larger by four times the largest error.
//
// A surface that several images see becomes points of the image whose pixels
// cover least of it (depth / focal length), in steps of a factor of 1.5, and of
// the first image among those in the same step. With exact sizes, among views
// at about the same distance the depth with the largest error towards its
// camera would always be chosen.
//
// The point lies on the ray of the pixel. A source's depth for it is where the
// ray meets the plane through the source's point with its normal.
//
// place: the index of the image, see FusionSourceInput. sources: at most
// kMaxFusionSources. The result does not depend on the device or the number of
// threads.
std::vector<FusedPoint> FuseView(const FusionInput& view,
                                 int place,
                                 const std::vector<FusionSourceInput>& sources,
                                 const FusionOptions& options,
                                 Device& device);

}  // namespace tsar
