// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/depth_image.h"

#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/array_files.h"
#include "colmap_tsar/io/picture_checks.h"
#include "colmap_tsar/io/png.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

std::string LowerExtension(const std::filesystem::path& path) {
  return FoldedCase(path.extension().string());
}

bool HasThreeEqualChannels(const FloatMap& map) {
  if (map.channels != 3) {
    return false;
  }
  for (size_t i = 0; i < map.values.size(); i += 3) {
    // NaN equals NaN here.
    const auto same = [](float a, float b) {
      return a == b || (a != a && b != b);
    };
    if (!same(map.values[i], map.values[i + 1]) ||
        !same(map.values[i], map.values[i + 2])) {
      return false;
    }
  }
  return true;
}

void KeepFirstChannel(FloatMap* map) {
  for (size_t i = 0; i < map->values.size() / 3; ++i) {
    map->values[i] = map->values[3 * i];
  }
  map->values.resize(map->values.size() / 3);
  map->channels = 1;
}

PngHeader RequirePngHeader(std::span<const uint8_t> bytes,
                           const std::string& name) {
  const std::optional<PngHeader> header = ReadPngHeader(bytes);
  if (!header) {
    throw ByteReader(bytes, name).Corrupt("not a PNG file");
  }
  return *header;
}

template <typename T>
Image<T> DecodeValues(std::span<const uint8_t> bytes, const std::string& name) {
  return DecodePng<T>(bytes, [&](const std::string& defect) {
    return ByteReader(bytes, name)
        .Corrupt("the PNG file is damaged: " + defect);
  });
}

DepthImage ParsePng(std::span<const uint8_t> bytes, const std::string& name) {
  const PngHeader header = RequirePngHeader(bytes, name);
  if (header.bits_per_channel != 16 || !header.is_gray) {
    throw Error::File(
        ErrorCode::kUnsupported,
        name,
        "a picture of " + std::to_string(header.bits_per_channel) + " bits" +
            (header.is_gray ? "" : " in colors") + ", not a depth map",
        "save depth as PNG of 16 bits in gray, or as EXR, TIFF, "
        "PFM or NPY");
  }
  const Image<uint16_t> values = DecodeValues<uint16_t>(bytes, name);
  DepthImage image;
  image.is_integer = true;
  image.map.width = values.Width();
  image.map.height = values.Height();
  image.map.channels = 1;
  image.map.values.assign(values.begin(), values.end());
  return image;
}

// Decodes TIFF and EXR, with the channels in OpenCV's order.
cv::Mat DecodeChecked(std::span<const uint8_t> bytes,
                      const std::string& extension,
                      const std::string& name) {
  constexpr size_t kMaxBytes = size_t{1} << 31;
  const ByteReader reader(bytes, name);
  if (bytes.empty() || bytes.size() >= kMaxBytes) {
    throw reader.Corrupt(bytes.empty() ? "the file is empty"
                                       : "the file is too large for a picture");
  }
  if (extension == ".exr") {
    CheckExr(bytes, name);
    // Builds of OpenCV with OpenEXR may still require this variable.
    setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  } else {
    if (const std::string defect = FindTiffDefect(bytes); !defect.empty()) {
      throw reader.Corrupt("the TIFF file is damaged: " + defect);
    }
  }
  cv::Mat pixels = DecodePicture(bytes, cv::IMREAD_UNCHANGED);
  if (pixels.empty() && extension == ".exr" &&
      !cv::haveImageWriter("depth.exr")) {
    throw Error::File(ErrorCode::kUnsupported,
                      name,
                      "this build of OpenCV cannot read EXR",
                      "save depth as TIFF, PFM or NPY");
  }
  if (pixels.empty()) {
    throw reader.Corrupt("not a readable picture");
  }
  return pixels;
}

// Converts one or three channels with unchanged values.
FloatMap ToFloatMap(const cv::Mat& pixels) {
  FloatMap map;
  map.width = pixels.cols;
  map.height = pixels.rows;
  map.channels = pixels.channels();
  map.values.resize(pixels.total() * static_cast<size_t>(pixels.channels()));
  cv::Mat target(
      pixels.rows, pixels.cols, CV_32FC(pixels.channels()), map.values.data());
  pixels.convertTo(target, CV_32F);
  if (map.channels == 3) {
    for (size_t i = 0; i < map.values.size(); i += 3) {
      std::swap(map.values[i], map.values[i + 2]);
    }
  }
  return map;
}

DepthImage ParsePicture(std::span<const uint8_t> bytes,
                        const std::string& extension,
                        const std::string& name) {
  const cv::Mat pixels = DecodeChecked(bytes, extension, name);
  const int depth = pixels.depth();
  if ((depth != CV_16U && depth != CV_32F && depth != CV_64F) ||
      (pixels.channels() != 1 && pixels.channels() != 3)) {
    throw Error::File(ErrorCode::kUnsupported,
                      name,
                      "a picture, not a depth map",
                      "save depth in one channel of 16 bits or of floats");
  }
  DepthImage image = {ToFloatMap(pixels), depth == CV_16U};
  if (HasThreeEqualChannels(image.map)) {
    KeepFirstChannel(&image.map);
  }
  return image;
}

// A normal map; integer values reach up to max_value.
struct StoredNormals {
  FloatMap map;
  std::optional<float> max_value;
};

StoredNormals ParseNormalPng(std::span<const uint8_t> bytes,
                             const std::string& name) {
  const PngHeader header = RequirePngHeader(bytes, name);
  StoredNormals normals;
  normals.max_value = 65535.f;
  if (!header.has_colors) {
    normals.map.channels = 1;
    return normals;
  }
  const Image<Rgb16> values = DecodeValues<Rgb16>(bytes, name);
  normals.map.width = values.Width();
  normals.map.height = values.Height();
  normals.map.channels = 3;
  normals.map.values.reserve(3 * values.NumPixels());
  for (const Rgb16& value : values) {
    for (const uint16_t element : {value.r, value.g, value.b}) {
      normals.map.values.push_back(element);
    }
  }
  return normals;
}

StoredNormals ParseStoredNormals(std::span<const uint8_t> bytes,
                                 const std::string& extension,
                                 const std::string& name) {
  if (extension == ".pfm") {
    return {ParsePfm(bytes, name), std::nullopt};
  }
  if (extension == ".png") {
    return ParseNormalPng(bytes, name);
  }
  if (extension == ".npy") {
    NpyArray array = ParseNpy(bytes, name);
    return {std::move(array.map),
            array.is_integer ? std::optional(65535.f) : std::nullopt};
  }
  const cv::Mat pixels = DecodeChecked(bytes, extension, name);
  switch (pixels.channels() == 3 ? pixels.depth() : -1) {
    case CV_8U:
      return {ToFloatMap(pixels), 255.f};
    case CV_16U:
      return {ToFloatMap(pixels), 65535.f};
    case CV_32F:
    case CV_64F:
      return {ToFloatMap(pixels), std::nullopt};
    default:
      return {};
  }
}

// Maps integers from [0, max_value] to [-1, 1]. A result far from a unit
// vector, such as that of black, becomes 0.
void DecodeIntegers(float max_value, std::vector<float>* values) {
  constexpr float kMinNorm = 0.5f;
  constexpr float kMaxNorm = 1.5f;
  for (size_t i = 0; i < values->size(); i += 3) {
    float* normal = values->data() + i;
    float squares = 0.f;
    for (int c = 0; c < 3; ++c) {
      normal[c] = 2.f * normal[c] / max_value - 1.f;
      squares += normal[c] * normal[c];
    }
    if (squares < kMinNorm * kMinNorm || squares > kMaxNorm * kMaxNorm) {
      std::fill_n(normal, 3, 0.f);
    }
  }
}

}  // namespace

bool IsDepthImageName(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 6> kExtensions = {
      ".png", ".exr", ".tif", ".tiff", ".pfm", ".npy"};
  return std::ranges::find(kExtensions, LowerExtension(path)) !=
         kExtensions.end();
}

DepthImage ParseDepthImage(std::span<const uint8_t> bytes,
                           const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  if (extension == ".pfm") {
    return {ParsePfm(bytes, path.string()), false};
  }
  if (extension == ".npy") {
    NpyArray array = ParseNpy(bytes, path.string());
    return {std::move(array.map), array.is_integer};
  }
  if (extension == ".png") {
    return ParsePng(bytes, path.string());
  }
  return ParsePicture(bytes, extension, path.string());
}

FloatMap ParseNormalImage(std::span<const uint8_t> bytes,
                          const std::filesystem::path& path) {
  StoredNormals normals =
      ParseStoredNormals(bytes, LowerExtension(path), path.string());
  if (normals.map.channels != 3) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "not a map of normals, which has three channels",
                      "save normals as PNG in colors, or as EXR, TIFF, PFM or "
                      "NPY of floats");
  }
  if (normals.max_value) {
    DecodeIntegers(*normals.max_value, &normals.map.values);
  }
  return std::move(normals.map);
}

}  // namespace tsar
