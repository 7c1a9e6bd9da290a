// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/scenes.h"

#include "colmap_tsar/base/random.h"

namespace tsar {
namespace {

constexpr int kSquare = 8;

DeviceImage<uint8_t> ThreeOfFour(int width, int height, Device& device) {
  Image<uint8_t> mask(width, height);
  Philox random(21, 0, 0);
  for (uint8_t& value : mask) {
    value = random.NextBelow(4) != 0 ? 1 : 0;
  }
  return DeviceImage<uint8_t>(device, mask);
}

Superpixels Squares(const ReducedRaster& raster, Device& device) {
  const int columns = (raster.width + kSquare - 1) / kSquare;
  const int rows = (raster.height + kSquare - 1) / kSquare;
  Image<int> labels(raster.width, raster.height);
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      labels(x, y) = y / kSquare * columns + x / kSquare;
    }
  }
  return {DeviceImage<int>(device, labels), columns * rows};
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const SceneSize& size) {
  const char* kind = size.kind == SceneKind::kWall      ? "wall"
                     : size.kind == SceneKind::kInvalid ? "without depth"
                                                        : "all equal";
  return out << size.width << " x " << size.height << ", " << kind;
}

std::vector<SceneSize> AllScenes() {
  std::vector<SceneSize> scenes;
  for (const SceneKind kind :
       {SceneKind::kWall, SceneKind::kInvalid, SceneKind::kEqual}) {
    scenes.push_back({kind, 1, 1});
    scenes.push_back({kind, 1, 37});
    scenes.push_back({kind, 97, 61});
  }
  // The raster is smaller than the map.
  scenes.push_back({SceneKind::kWall, 1201, 37});
  return scenes;
}

std::vector<SceneSize> AllScenesAndWide() {
  std::vector<SceneSize> scenes = AllScenes();
  scenes.push_back({SceneKind::kWall, 65539, 3});
  scenes.push_back({SceneKind::kWall, 811, 900});
  return scenes;
}

SyntheticViews DrawScene(const SceneSize& size) {
  SyntheticViewsOptions options;
  options.width = size.width;
  options.height = size.height;
  SyntheticViews drawn = MakeSyntheticViews(options);
  for (ViewData& view : drawn.views) {
    if (size.kind == SceneKind::kInvalid) {
      view.depth = Image<float>(size.width, size.height, 0.f);
      view.normal = Image<Vec3f>(size.width, size.height);
    } else if (size.kind == SceneKind::kEqual) {
      view.depth = Image<float>(size.width, size.height, 5.f);
      view.normal = Image<Vec3f>(size.width, size.height, {0.f, 0.f, -1.f});
      view.color = Image<Rgb>(size.width, size.height, {90, 100, 110});
    }
  }
  return drawn;
}

Image<float> RandomImage(int width, int height, float max, uint32_t seed) {
  Image<float> image(width, height);
  Philox random(seed, 0, 0);
  for (float& value : image) {
    value = max * random.NextFloat();
  }
  return image;
}

StageInputs::StageInputs(const SceneSize& size, Device& device)
    : drawn(DrawScene(size)),
      views(drawn.views[0], UploadViews(drawn.Sources(), device), device),
      score(device, RandomImage(size.width, size.height, 1.2f, 20)),
      reliable(ThreeOfFour(size.width, size.height, device)),
      samples(SampleMeasurements(views.Hypotheses().depth,
                                 score.View(),
                                 reliable.View(),
                                 views.MapIntrinsics(),
                                 views.Raster(),
                                 device)),
      squares(Squares(views.Raster(), device)) {}

}  // namespace tsar
