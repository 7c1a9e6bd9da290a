// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/external_writers.h"

#include <array>
#include <bit>
#include <sstream>

#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

std::span<const uint8_t> AsBytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

std::vector<float> ValuesOf(const Image<float>& map) {
  return {map.begin(), map.end()};
}

std::vector<float> ValuesOf(const Image<Vec3f>& map) {
  std::vector<float> values;
  for (const Vec3f& n : map) {
    values.insert(values.end(), {n.x, n.y, n.z});
  }
  return values;
}

std::string FloatData(const std::vector<float>& values) {
  std::string data;
  for (const float value : values) {
    Append(value, &data);
  }
  return data;
}

std::string DmbBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values) {
  std::string bytes;
  for (const int number : {1, height, width, channels}) {
    Append(static_cast<int32_t>(number), &bytes);
  }
  return bytes + FloatData(values);
}

std::string ApdBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values,
                     bool has_version) {
  std::string bytes;
  if (has_version) {
    Append(int32_t{1}, &bytes);
  }
  for (const int number : {height, width, CV_32FC(channels)}) {
    Append(static_cast<int32_t>(number), &bytes);
  }
  return bytes + FloatData(values);
}

std::string DmapBytes(const DmapContent& content) {
  const Image<float>& depth = content.depth;
  std::string bytes = "DR";
  bytes.push_back(static_cast<char>(1 + (content.normal.Empty() ? 0 : 2) +
                                    (content.has_confidence ? 4 : 0) +
                                    (content.has_views ? 8 : 0)));
  bytes.push_back('\0');
  for (const int number :
       {2 * depth.Width(), 2 * depth.Height(), depth.Width(), depth.Height()}) {
    Append(static_cast<uint32_t>(number), &bytes);
  }
  Append(0.5f, &bytes);
  Append(9.5f, &bytes);
  Append(static_cast<uint16_t>(content.image_name.size()), &bytes);
  bytes += content.image_name;
  for (const uint32_t number : {3u, 7u, 8u, 9u}) {
    Append(number, &bytes);
  }
  const Camera& camera = content.camera;
  for (const double value :
       {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0}) {
    Append(value, &bytes);
  }
  for (int i = 0; i < 9; ++i) {
    Append(camera.rotation(i / 3, i % 3), &bytes);
  }
  for (int i = 0; i < 3; ++i) {
    Append(camera.Center()[i], &bytes);
  }
  bytes += FloatData(ValuesOf(depth)) + FloatData(ValuesOf(content.normal));
  for (const bool has : {content.has_confidence, content.has_views}) {
    if (has) {
      bytes += FloatData(std::vector<float>(depth.NumPixels(), 3.f));
    }
  }
  return bytes;
}

std::string PfmBytes(int width,
                     int height,
                     int channels,
                     const std::vector<float>& values,
                     bool is_little_endian) {
  std::ostringstream header;
  header << (channels == 1 ? "Pf" : "PF") << "\n"
         << width << " " << height << "\n"
         << (is_little_endian ? "-1.0" : "1.0") << "\n";
  std::string bytes = header.str();
  const int row = width * channels;
  for (int y = height - 1; y >= 0; --y) {
    for (int i = 0; i < row; ++i) {
      const auto bits = std::bit_cast<uint32_t>(values[y * row + i]);
      Append(is_little_endian ? bits : __builtin_bswap32(bits), &bytes);
    }
  }
  return bytes;
}

std::string NpyBytes(const std::string& type,
                     const std::string& shape,
                     const std::string& data,
                     const std::string& order) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order +
                       ", 'shape': " + shape + ", }";
  while ((10 + header.size() + 1) % 64 != 0) {
    header.push_back(' ');
  }
  header.push_back('\n');
  std::string bytes = "\x93NUMPY";
  bytes += std::string("\x01\x00", 2);
  Append(static_cast<uint16_t>(header.size()), &bytes);
  return bytes + header + data;
}

std::string PngBytes(int width,
                     int height,
                     const std::vector<uint16_t>& values) {
  cv::Mat pixels(height, width, CV_16UC1);
  std::copy(values.begin(), values.end(), pixels.begin<uint16_t>());
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(".png", pixels, bytes));
  return {bytes.begin(), bytes.end()};
}

std::string CamBytes(const Camera& camera) {
  std::ostringstream text;
  text.precision(12);
  text << "extrinsic\n";
  for (int row = 0; row < 3; ++row) {
    text << camera.rotation.row(row) << " " << camera.translation[row] << "\n";
  }
  text << "0 0 0 1\n\nintrinsic\n"
       << camera.fx << " 0 " << camera.cx << "\n0 " << camera.fy << " "
       << camera.cy << "\n0 0 1\n\n0.5 0.1 192 10\n";
  return text.str();
}

}  // namespace tsar
