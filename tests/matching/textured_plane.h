// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A textured plane seen by a reference camera at the origin and by sources.

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cmath>
#include <utility>
#include <vector>

#include "tests/matching/gray_textures.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"

namespace tsar {

// Owns the rasters to which a ReferenceView and its SourceViews point.
class TexturedPlane {
 public:
  TexturedPlane(const Plane& plane, const Camera& camera, Device& device)
      : plane_(plane),
        camera_(camera),
        device_(device),
        on_device_(device),
        depth_(DrawDepth(plane, camera)),
        normal_(camera.width, camera.height, plane.normal),
        gray_(Render(camera).first) {}

  // Adds a source with gray levels contrast * texture + brightness.
  void AddSource(const Camera& source,
                 float contrast = 1.f,
                 float brightness = 0.f) {
    auto [gray, depth] = Render(source);
    for (float& value : gray) {
      value = contrast * value + brightness;
    }
    rasters_.push_back({std::move(gray), std::move(depth)});
    views_.push_back(
        {source.GetIntrinsics(), ComputeRelativePose(camera_, source), {}, {}});
  }

  ReferenceView Reference() const {
    return {camera_.GetIntrinsics(),
            InTexture(gray_),
            on_device_(depth_),
            on_device_(normal_)};
  }
  SourceViews Sources() {
    SourceViews sources(device_, HostSources());
    // Other devices may read them.
    device_.Synchronize();
    return sources;
  }
  // The same, in the host's memory; their rasters are in the device's.
  const std::vector<SourceView>& HostSources() {
    for (size_t i = 0; i < views_.size(); ++i) {
      views_[i].gray = InTexture(rasters_[i].gray);
      views_[i].depth = on_device_(rasters_[i].depth);
    }
    return views_;
  }

  Image<float>& Gray() { return gray_; }
  Image<float>& Depth() { return depth_; }
  const Vec3f& Normal() const { return plane_.normal; }
  Image<float>& SourceGray(int i) { return rasters_[i].gray; }
  Image<float>& SourceDepth(int i) { return rasters_[i].depth; }

 private:
  struct Rasters {
    Image<float> gray;
    Image<float> depth;
  };

  GrayView InTexture(const Image<float>& gray) const {
    textures_.push_back(TextureOf(gray, device_));
    return textures_.back().View();
  }

  // Waves of about six to fifteen pixels in three directions.
  static float Texture(const Eigen::Vector3d& point) {
    const double x = point.x() / 0.03;
    const double y = point.y() / 0.03;
    return static_cast<float>(128.0 + 40.0 * std::sin(0.9 * x + 0.2 * y) +
                              30.0 * std::sin(0.61 * y - 0.35 * x + 1.0) +
                              20.0 * std::sin(0.43 * x + 0.47 * y + 2.0));
  }

  // The gray levels and the depths that a camera sees.
  std::pair<Image<float>, Image<float>> Render(const Camera& camera) const {
    Image<float> gray(camera.width, camera.height);
    Image<float> depth(camera.width, camera.height);
    const Eigen::Vector3d normal(
        plane_.normal.x, plane_.normal.y, plane_.normal.z);
    const Eigen::Vector3d center = camera.Center();
    ForEachPixel(camera.width, camera.height, [&](int x, int y) {
      const Eigen::Vector3d ray =
          camera.rotation.transpose() *
          Eigen::Vector3d(
              (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      const double z = -(normal.dot(center) + plane_.offset) / normal.dot(ray);
      depth(x, y) = z > 0.0 ? static_cast<float>(z) : 0.f;
      gray(x, y) = Texture(center + z * ray);
    });
    return {std::move(gray), std::move(depth)};
  }

  Plane plane_;
  Camera camera_;
  Device& device_;
  mutable DeviceCopies on_device_;
  mutable std::vector<GrayTexture> textures_;
  Image<float> depth_;
  Image<Vec3f> normal_;
  Image<float> gray_;
  std::vector<Rasters> rasters_;
  std::vector<SourceView> views_;
};

// A camera at center, turned about the vertical axis by angle (radians).
inline Camera SourceCamera(const Camera& reference,
                           const Eigen::Vector3d& center,
                           double angle) {
  Camera camera = reference;
  camera.rotation << std::cos(angle), 0.0, -std::sin(angle), 0.0, 1.0, 0.0,
      std::sin(angle), 0.0, std::cos(angle);
  camera.translation = -camera.rotation * center;
  return camera;
}

}  // namespace tsar
