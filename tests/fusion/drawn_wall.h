// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/fusion/fuse_images.h"
#include "colmap_tsar/fusion/fuse_view.h"

#include <limits>
#include <vector>

namespace tsar {

// A wall at z = 4 in the world, seen head-on by cameras at z <= 0, of 40 x 30
// pixels and a focal length of 40 pixels: from z = 0 a pixel covers 0.1 of the
// wall.
struct DrawnWall {
  static constexpr int kWidth = 40;
  static constexpr int kHeight = 30;
  static constexpr double kFocalLength = 40.0;
  static constexpr float kDepth = 4.f;

  // x: the camera's; distance: to the wall.
  static FusionView View(double x, double distance = kDepth) {
    FusionView view;
    Camera& camera = view.camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.fx = camera.fy = kFocalLength;
    camera.cx = 0.5 * kWidth;
    camera.cy = 0.5 * kHeight;
    camera.translation = {-x, 0.0, distance - kDepth};
    FusionPixel pixel;
    pixel.depth = static_cast<float>(distance);
    EncodeNormal({0.f, 0.f, -1.f}, &pixel);
    pixel.confidence = std::numeric_limits<uint8_t>::max();
    pixel.sigma = EncodeSigma(0.01f);
    pixel.color = {100, 150, 200};
    view.pixels = Image<FusionPixel>(kWidth, kHeight, pixel);
    return view;
  }

  static FusionInput InputOf(const FusionView& view) {
    return {view.camera, view.pixels.View()};
  }

  // Points of view number `place` of several, all of which are fused.
  static std::vector<FusedPoint> Fuse(const std::vector<FusionView>& views,
                                      int place,
                                      const FusionOptions& options) {
    std::vector<FusionSourceInput> sources;
    for (int i = 0; i < static_cast<int>(views.size()); ++i) {
      if (i != place) {
        sources.push_back({InputOf(views[i]), true, i});
      }
    }
    return FuseView(
        InputOf(views[place]), place, sources, options, *Device::CreateCpu(1));
  }

  static FusionOptions DensestOptions() {
    FusionOptions options;
    options.point_spacing = 1;
    return options;
  }
};

}  // namespace tsar
