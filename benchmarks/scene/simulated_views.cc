// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/simulated_views.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>

#include "benchmarks/scene/texture.h"
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// Where two surfaces meet, a pixel is the mean of the square of this many rays.
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

// Windows with less contrast (a standard deviation in gray levels) have nothing
// to match.
constexpr float kMinContrast = 2.5f;
constexpr int kWindow = 11;

// Spread of good depths in pixels of disparity, for a baseline in meters.
constexpr double kMatchingNoise = 0.15;
constexpr double kBaseline = 0.3;
// Spread of the normals' components.
constexpr float kNormalNoise = 0.08f;

constexpr double kOutlierShare = 0.03;
constexpr double kOutlierError = 0.3;
constexpr double kKeptOutlierShare = 0.15;
constexpr double kRejectedShare = 0.06;

// Wrong surfaces: relative error, and cells per image width of its waves.
constexpr double kWrongError = 0.25;
constexpr double kWrongCells = 14.0;
// Cells per image width of the blobs that the filter keeps or rejects as one,
// and the heights of the noise above which it does.
constexpr double kBlobCells = 90.0;
constexpr double kKeptBlob = 0.75;
constexpr double kRejectedBlob = 0.7;

// Standard deviation of the gray levels in a window around each pixel.
Image<float> LocalContrast(const Image<Rgb>& color) {
  const cv::Mat rgb(
      color.Height(), color.Width(), CV_8UC3, const_cast<Rgb*>(color.Data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  gray.convertTo(gray, CV_32F);
  cv::Mat mean;
  cv::Mat mean_square;
  const cv::Size window(kWindow, kWindow);
  cv::boxFilter(gray, mean, -1, window);
  cv::boxFilter(gray.mul(gray), mean_square, -1, window);
  Image<float> contrast(color.Width(), color.Height());
  for (int y = 0; y < color.Height(); ++y) {
    for (int x = 0; x < color.Width(); ++x) {
      const float m = mean.at<float>(y, x);
      const float variance = mean_square.at<float>(y, x) - m * m;
      contrast(x, y) = std::sqrt(std::max(variance, 0.f));
    }
  }
  return contrast;
}

// About normal, with standard deviation 1.
double Gaussian(Philox* random) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    sum += 2.0 * random->NextFloat() - 1.0;
  }
  return sum;
}

// What the two maps say about one pixel.
struct SimulatedPixel {
  double depth;
  Vec3f normal;
  bool is_kept;  // By the filter.
};

class SimulatedMapPainter {
 public:
  SimulatedMapPainter(const RenderedView& view, uint32_t noise_key)
      : view_(view),
        contrast_(LocalContrast(view.color)),
        noise_key_(noise_key),
        waves_(noise_key) {}

  void PaintRow(int y, SimulatedMaps* maps) const {
    Philox random(noise_key_, static_cast<uint32_t>(y), 2);
    for (int x = 0; x < view_.depth.Width(); ++x) {
      const bool has_texture = contrast_(x, y) >= kMinContrast;
      const SimulatedPixel pixel =
          has_texture ? Matched(x, y, &random) : Guessed(x, y, &random);
      const Vec3f normal = FaceCamera(x, y, pixel.normal);
      const auto depth = static_cast<float>(pixel.depth);
      maps->photometric.depth(x, y) = depth;
      maps->photometric.normal(x, y) = normal;
      if (pixel.is_kept) {
        maps->geometric.depth(x, y) = depth;
        maps->geometric.normal(x, y) = normal;
      }
    }
  }

 private:
  SimulatedPixel Matched(int x, int y, Philox* random) const {
    const double z = view_.depth(x, y);
    const bool is_outlier = random->NextFloat() < kOutlierShare;
    const double spread =
        is_outlier ? kOutlierError
                   : kMatchingNoise * z / (view_.camera.fx * kBaseline);
    const float keep = random->NextFloat();
    return {z * std::exp(spread * Gaussian(random)),
            Jitter(view_.normal(x, y), random),
            is_outlier ? keep < kKeptOutlierShare
                       : keep >= kRejectedShare &&
                             Wave(x, y, kBlobCells, 3) < kRejectedBlob};
  }

  SimulatedPixel Guessed(int x, int y, Philox* random) const {
    const Vec3f bend{static_cast<float>(Wave(x, y, kWrongCells, 1)),
                     static_cast<float>(Wave(x, y, kWrongCells, 2)),
                     0.f};
    return {
        view_.depth(x, y) * std::exp(kWrongError * Wave(x, y, kWrongCells, 0)),
        Jitter(view_.normal(x, y) + bend, random),
        Wave(x, y, kBlobCells, 4) > kKeptBlob};
  }

  // In [-1, 1]; each channel is another function.
  double Wave(int x, int y, double cells_per_width, int channel) const {
    const double cells = cells_per_width / view_.depth.Width();
    return waves_.Value(x * cells + 50.3 * channel, y * cells);
  }

  static Vec3f Jitter(const Vec3f& normal, Philox* random) {
    Vec3f shift;
    shift.x = kNormalNoise * static_cast<float>(Gaussian(random));
    shift.y = kNormalNoise * static_cast<float>(Gaussian(random));
    shift.z = kNormalNoise * static_cast<float>(Gaussian(random));
    return Normalized(normal + shift);
  }

  // Turns a normal that looks away from the camera back along the ray.
  Vec3f FaceCamera(int x, int y, const Vec3f& normal) const {
    const Vec3f ray = view_.camera.GetIntrinsics().Ray(static_cast<float>(x),
                                                       static_cast<float>(y));
    return Dot(normal, ray) < -0.1f * Norm(ray) ? normal : -Normalized(ray);
  }

  const RenderedView& view_;
  Image<float> contrast_;
  uint32_t noise_key_;
  LatticeNoise waves_;
};

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

SimulatedMaps SimulateStereoMaps(const RenderedView& view,
                                 uint32_t noise_key,
                                 ThreadPool& threads) {
  SimulatedMaps maps;
  for (DepthNormal* map : {&maps.photometric, &maps.geometric}) {
    map->depth = Image<float>(view.depth.Width(), view.depth.Height());
    map->normal = Image<Vec3f>(view.depth.Width(), view.depth.Height());
  }
  const SimulatedMapPainter painter(view, noise_key);
  threads.Run(view.depth.Height(), [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      painter.PaintRow(static_cast<int>(y), &maps);
    }
  });
  return maps;
}

}  // namespace tsar
