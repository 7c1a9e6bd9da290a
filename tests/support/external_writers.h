// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// Files as other programs write them.

std::span<const uint8_t> AsBytes(const std::string& text);

// The values of a raster, the channels of a pixel side by side.
std::vector<float> ValuesOf(const Image<float>& map);
std::vector<float> ValuesOf(const Image<Vec3f>& map);

std::string DmbBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values);

std::string ApdBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values,
                     bool has_version);

struct DmapContent {
  std::string image_name = "images/a.png";
  Camera camera;  // Has the map's size.
  Image<float> depth;
  Image<Vec3f> normal;  // Empty: none.
  bool has_confidence = false;
  bool has_views = false;
};
std::string DmapBytes(const DmapContent& content);

std::string PfmBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values,
                     bool is_little_endian);

// A file of version 1 with these raw bytes as its data.
std::string NpyBytes(const std::string& type,
                     const std::string& shape,
                     const std::string& data,
                     const std::string& order = "False");

// The values as float32.
std::string FloatData(const std::vector<float>& values);

std::string PngBytes(int width,
                     int height,
                     const std::vector<uint16_t>& values);

// As MVSNet's converters write it.
std::string CamBytes(const Camera& camera);

}  // namespace tsar
