// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/read_prior.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/io/depth_image.h"
#include "colmap_tsar/io/float_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tsar {
namespace {

namespace fs = std::filesystem;

bool FitsPhoto(const RasterSize& size, const RasterSize& photo) {
  constexpr double kMaxRatio = 1.02;
  const double width = size.height / static_cast<double>(photo.height) *
                       static_cast<double>(photo.width);
  const double height = size.width / static_cast<double>(photo.width) *
                        static_cast<double>(photo.height);
  return std::max(width / size.width, size.width / width) <= kMaxRatio ||
         std::abs(width - size.width) <= 1.0 ||
         std::abs(height - size.height) <= 1.0;
}

void RequireFit(const fs::path& path,
                const FloatMap& map,
                const RasterSize& photo) {
  const RasterSize size = {map.width, map.height};
  if (!FitsPhoto(size, photo)) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "the depth prior has " + ToString(size) +
            " pixels, which is not the shape of its undistorted image of " +
            ToString(photo),
        "make it of the image in the workspace's folder images");
  }
}

// value_of: maps the channels of a pixel to its value.
template <typename T, typename ValueOf>
Image<T> ReduceMap(const FloatMap& map, const ValueOf& value_of) {
  const int side = std::max(map.width, map.height);
  auto image =
      Image<T>::Uninitialized(ReducedLength(map.width, side, kMaxPriorSide),
                              ReducedLength(map.height, side, kMaxPriorSide));
  for (int y = 0; y < image.Height(); ++y) {
    const int64_t row =
        int64_t{NearestPixel(y, map.height, image.Height())} * map.width;
    for (int x = 0; x < image.Width(); ++x) {
      const int64_t pixel = row + NearestPixel(x, map.width, image.Width());
      image(x, y) = value_of(map.values.data() + pixel * map.channels);
    }
  }
  return image;
}

float ToValue(const float* channel) {
  return std::isfinite(*channel) && *channel > 0.f ? *channel : 0.f;
}

Vec3f ToNormal(const float* channels) {
  const Vec3f normal = {channels[0], channels[1], channels[2]};
  return std::isfinite(Norm(normal)) ? Normalized(normal) : Vec3f{};
}

class PriorReader {
 public:
  explicit PriorReader(const RasterSize& photo) : photo_(photo) {}

  DepthPrior Read(const PriorFiles& files) {
    DepthPrior prior;
    if (!files.depth.empty()) {
      prior.values = ReduceMap<float>(ReadDepth(files.depth), &ToValue);
    }
    if (!files.normals.empty()) {
      prior.normals = ReduceMap<Vec3f>(
          ReadMap(files.normals, &ParseNormalImage), &ToNormal);
    }
    return prior;
  }

  // The memory of the larger of the files that were read, in bytes.
  int64_t NumBytes() const { return num_bytes_; }

 private:
  FloatMap ReadDepth(const fs::path& path) {
    FloatMap map =
        ReadMap(path, [](std::span<const uint8_t> bytes, const fs::path& file) {
          return ParseDepthImage(bytes, file).map;
        });
    if (map.channels != 1) {
      throw Error::File(
          ErrorCode::kUnsupported,
          path.string(),
          "has " + std::to_string(map.channels) + " channels, not one of depth",
          "save depth alone; normals have names that end in .normal" +
              path.extension().string());
    }
    return map;
  }

  template <typename Parse>
  FloatMap ReadMap(const fs::path& path, const Parse& parse) {
    // A value as OpenCV decodes it, and as it is returned.
    constexpr size_t kBytesPerValue = sizeof(double) + sizeof(float);
    const std::vector<uint8_t> bytes = ReadFileBytes(path);
    if (bytes.empty()) {
      throw Error::File(ErrorCode::kCorrupt,
                        path.string(),
                        "the file is empty",
                        "make the depth prior again");
    }
    FloatMap map = parse(bytes, path);
    RequireFit(path, map, photo_);
    num_bytes_ =
        std::max(num_bytes_,
                 static_cast<int64_t>(bytes.size() +
                                      map.values.size() * kBytesPerValue));
    return map;
  }

  const RasterSize photo_;
  int64_t num_bytes_ = 0;
};

}  // namespace

DepthPrior ReadPrior(const PriorFiles& files,
                     PriorType type,
                     const RasterSize& photo) {
  DepthPrior prior = PriorReader(photo).Read(files);
  prior.type = type;
  return prior;
}

PriorMemory CheckPrior(const PriorFiles& files, const RasterSize& photo) {
  PriorReader reader(photo);
  const DepthPrior prior = reader.Read(files);
  return {static_cast<int64_t>(prior.NumBytes()), reader.NumBytes()};
}

}  // namespace tsar
