// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/render.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// Where two surfaces meet, a pixel is the mean of this many rays squared.
constexpr int kRaysPerSide = 3;

// In gray levels, half the width of the noise of each channel: about what is
// left of a camera's noise after JPEG.
constexpr double kNoise = 1.2;

Eigen::Vector3d CastColor(const Room& room,
                          const Camera& camera,
                          double x,
                          double y) {
  const Ray ray = PixelRay(camera, x, y);
  const RoomHit hit = room.Cast(ray);
  return room.Shade(ray, hit, hit.point.distance / camera.fx);
}

Eigen::Vector3d MeanColor(const Room& room,
                          const Camera& camera,
                          int x,
                          int y) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < kRaysPerSide * kRaysPerSide; ++i) {
    const double dx = (i % kRaysPerSide + 0.5) / kRaysPerSide - 0.5;
    const double dy = (i / kRaysPerSide + 0.5) / kRaysPerSide - 0.5;
    sum += CastColor(room, camera, x + dx, y + dy);
  }
  return sum / (kRaysPerSide * kRaysPerSide);
}

bool IsOnEdge(const Image<int>& surfaces, int x, int y) {
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int column = x - 1; column <= x + 1; ++column) {
      if (surfaces.Contains(column, row) &&
          surfaces(column, row) != surfaces(x, y)) {
        return true;
      }
    }
  }
  return false;
}

uint8_t ToLevel(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

Rgb AddNoise(const Eigen::Vector3d& color, Philox* random) {
  const auto noisy = [&](double value) {
    return ToLevel(value + kNoise * (2.0 * random->NextFloat() - 1.0));
  };
  const uint8_t r = noisy(color.x());
  const uint8_t g = noisy(color.y());
  const uint8_t b = noisy(color.z());
  return {r, g, b};
}

}  // namespace

RenderedView RenderView(const Room& room,
                        const Camera& camera,
                        uint32_t noise_key,
                        ThreadPool& threads) {
  const int width = camera.width;
  const int height = camera.height;
  RenderedView view{camera,
                    Image<Rgb>(width, height),
                    Image<float>(width, height),
                    Image<Vec3f>(width, height)};
  Image<int> surfaces(width, height);
  threads.Run(height, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const RoomHit hit = room.Cast(PixelRay(camera, x, y));
        const Eigen::Vector3d normal = camera.rotation * hit.point.normal;
        surfaces(x, y) = hit.surface;
        view.depth(x, y) = static_cast<float>(hit.point.distance);
        view.normal(x, y) = {static_cast<float>(normal.x()),
                             static_cast<float>(normal.y()),
                             static_cast<float>(normal.z())};
      }
    }
  });
  threads.Run(height, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      Philox random(noise_key, static_cast<uint32_t>(y), 1);
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector3d color = IsOnEdge(surfaces, x, y)
                                          ? MeanColor(room, camera, x, y)
                                          : CastColor(room, camera, x, y);
        view.color(x, y) = AddNoise(color, &random);
      }
    }
  });
  return view;
}

}  // namespace tsar
