// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_files.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

Error Unsupported(const std::string& name,
                  const std::string& what,
                  const std::string& advice) {
  return Error::File(ErrorCode::kUnsupported, name, what, advice);
}

std::string LowerExtension(const std::filesystem::path& path) {
  return FoldedCase(path.extension().string());
}

// Reads the next word of a PFM header and one byte of white space after it.
std::string ReadWord(ByteReader* reader) {
  constexpr size_t kMaxLength = 40;
  std::string word;
  while (word.size() <= kMaxLength) {
    const char c = reader->Read<char>();
    if (std::string_view(" \t\r\n").find(c) == std::string_view::npos) {
      word.push_back(c);
    } else if (!word.empty()) {
      return word;
    }
  }
  throw reader->Corrupt("not a PFM file");
}

template <typename T>
T ReadNumber(ByteReader* reader) {
  const std::optional<T> number = ParseNumber<T>(ReadWord(reader));
  if (!number) {
    throw reader->Corrupt("the PFM header has no number where one is due");
  }
  return *number;
}

DepthImage ParsePfm(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name);
  const std::string kind = ReadWord(&reader);
  if (kind != "Pf" && kind != "PF") {
    throw reader.Corrupt("not a PFM file");
  }
  FloatMap map;
  map.channels = kind == "Pf" ? 1 : 3;
  map.width = ReadNumber<int>(&reader);
  map.height = ReadNumber<int>(&reader);
  const double scale = ReadNumber<double>(&reader);
  if (!(scale < 0.0) && !(scale > 0.0)) {
    throw reader.Corrupt("the scale of the PFM header is 0 or no number");
  }
  map.values.resize(RequireExactLength(
      reader, map.width, map.height, map.channels, sizeof(float)));
  const size_t row = static_cast<size_t>(map.width * map.channels);
  for (int y = map.height - 1; y >= 0; --y) {
    reader.ReadAll<float>(
        {map.values.data() + static_cast<size_t>(y) * row, row});
  }
  if (scale > 0.0) {
    for (float& value : map.values) {
      value = std::bit_cast<float>(
          __builtin_bswap32(std::bit_cast<uint32_t>(value)));
    }
  }
  return {std::move(map), false};
}

// The text between two others in the header of an array, a Python dictionary.
std::string_view Between(std::string_view header,
                         std::string_view before,
                         char after,
                         const ByteReader& reader) {
  const size_t begin = header.find(before);
  const size_t end = begin == std::string_view::npos
                         ? begin
                         : header.find(after, begin + before.size());
  if (end == std::string_view::npos) {
    throw reader.Corrupt("the NumPy header has no " + std::string(before));
  }
  return header.substr(begin + before.size(), end - begin - before.size());
}

// The numbers of a shape such as "480, 640".
std::vector<int64_t> ParseShape(std::string_view text,
                                const ByteReader& reader) {
  std::vector<int64_t> shape;
  const char* next = text.data();
  const char* const end = next + text.size();
  while (next < end) {
    int64_t number = 0;
    const auto [after, error] = std::from_chars(next, end, number);
    if (error != std::errc()) {
      throw reader.Corrupt("the NumPy header has a shape that is none");
    }
    shape.push_back(number);
    next = std::find_if_not(
        after, end, [](char c) { return c == ',' || c == ' '; });
  }
  return shape;
}

DepthImage ParseNpy(std::span<const uint8_t> bytes, const std::string& name) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  ByteReader reader(bytes, name);
  const std::span<const uint8_t> magic = reader.Take(kMagic.size());
  const auto version = reader.Read<std::array<uint8_t, 2>>();
  if (std::memcmp(magic.data(), kMagic.data(), kMagic.size()) != 0) {
    throw reader.Corrupt("not a NumPy array");
  }
  const size_t length =
      version[0] == 1 ? reader.Read<uint16_t>() : reader.Read<uint32_t>();
  const std::span<const uint8_t> text = reader.Take(length);
  const std::string header(text.begin(), text.end());
  const std::string type(Between(header, "'descr': '", '\'', reader));
  if (type != "<f2" && type != "<f4" && type != "<f8" && type != "<u2") {
    throw Unsupported(name,
                      "its values are of the type '" + type + "'",
                      "save float16, float32, float64 or uint16");
  }
  if (Between(header, "'fortran_order': ", ',', reader) != "False") {
    throw Unsupported(name,
                      "its columns are stored one after the other",
                      "save numpy.ascontiguousarray of it");
  }
  std::vector<int64_t> shape =
      ParseShape(Between(header, "'shape': (", ')', reader), reader);
  // Batches of one image.
  while (shape.size() > 3 && shape.front() == 1) {
    shape.erase(shape.begin());
  }
  const auto is_num_channels = [](int64_t n) { return n == 1 || n == 3; };
  const bool is_planar = shape.size() == 3 && is_num_channels(shape[0]) &&
                         !is_num_channels(shape[2]);
  if (is_planar) {
    std::rotate(shape.begin(), shape.begin() + 1, shape.end());
  }
  if (shape.size() != 2 && shape.size() != 3) {
    throw Unsupported(name,
                      "it has " + std::to_string(shape.size()) + " dimensions",
                      "save an array of shape (height, width)");
  }
  const int64_t channels = shape.size() == 3 ? shape[2] : 1;
  std::vector<float> values(
      RequireExactLength(reader,
                         shape[1],
                         shape[0],
                         channels,
                         static_cast<size_t>(type[2] - '0')));
  const auto read_values = [&]<typename T>(const auto& to_float) {
    std::vector<T> stored(values.size());
    reader.ReadAll(std::span(stored));
    std::ranges::transform(stored, values.begin(), to_float);
  };
  const auto cast = [](auto value) { return static_cast<float>(value); };
  if (type == "<f2") {
    read_values.operator()<uint16_t>(&HalfToFloat);
  } else if (type == "<u2") {
    read_values.operator()<uint16_t>(cast);
  } else if (type == "<f4") {
    reader.ReadAll(std::span(values));
  } else {
    read_values.operator()<double>(cast);
  }
  if (is_planar && channels > 1) {
    const std::vector<float> planes = std::move(values);
    const size_t num_pixels = planes.size() / 3;
    values.resize(planes.size());
    for (size_t i = 0; i < planes.size(); ++i) {
      values[i] = planes[i % 3 * num_pixels + i / 3];
    }
  }
  return {{static_cast<int>(shape[1]),
           static_cast<int>(shape[0]),
           static_cast<int>(channels),
           std::move(values)},
          type == "<u2"};
}

// An archive that numpy.savez made of one array, whose bytes stand in it as
// they are, between an entry and the directory of all.
DepthImage ParseNpz(std::span<const uint8_t> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              bytes.size());
  constexpr size_t kEndBytes = 22;
  constexpr size_t kCountOffset = 10;
  const size_t begin = std::min(text.find("\x93NUMPY"), text.size());
  const size_t end = text.rfind("PK\1\2");
  const std::string_view last =
      text.substr(std::max(text.size(), kEndBytes) - kEndBytes);
  if (!text.starts_with("PK\3\4") || end == std::string_view::npos ||
      end < begin || !last.starts_with("PK\5\6") || last[kCountOffset] != 1) {
    throw ByteReader(bytes, name, "save it with numpy.save")
        .Corrupt("not an uncompressed archive of one array");
  }
  return ParseNpy(bytes.subspan(begin, end - begin), name);
}

// The channels are in OpenCV's order.
cv::Mat DecodeMap(std::span<const uint8_t> bytes, const std::string& name) {
  // Builds of OpenCV with OpenEXR may still require this variable.
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  cv::Mat pixels = DecodePicture(bytes, cv::IMREAD_UNCHANGED);
  if (pixels.empty()) {
    throw ByteReader(bytes, name, "make the file again, as TIFF, PFM or NPY")
        .Corrupt("OpenCV cannot decode it");
  }
  if (pixels.channels() == 4) {
    cv::cvtColor(pixels, pixels, cv::COLOR_BGRA2BGR);
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
    cv::cvtColor(target, target, cv::COLOR_BGR2RGB);
  }
  return map;
}

// Keeps one of three equal channels.
void MergeEqualChannels(FloatMap* map) {
  const auto same = [](float a, float b) {
    return a == b || (std::isnan(a) && std::isnan(b));
  };
  std::vector<float> first;
  for (size_t i = 0; i < map->values.size(); i += 3) {
    const float* pixel = &map->values[i];
    if (map->channels != 3 || !same(pixel[0], pixel[1]) ||
        !same(pixel[0], pixel[2])) {
      return;
    }
    first.push_back(pixel[0]);
  }
  map->values = std::move(first);
  map->channels = 1;
}

DepthImage ParsePicture(std::span<const uint8_t> bytes,
                        const std::string& name) {
  const cv::Mat pixels = DecodeMap(bytes, name);
  const int depth = pixels.depth();
  if ((depth != CV_16U && depth != CV_32F && depth != CV_64F) ||
      (pixels.channels() != 1 && pixels.channels() != 3)) {
    throw Unsupported(name,
                      "a picture of " + std::to_string(8 * pixels.elemSize1()) +
                          " bits, not a depth map",
                      "save depth as PNG of 16 bits in gray, or as EXR, TIFF, "
                      "PFM or NPY");
  }
  DepthImage image = {ToFloatMap(pixels), depth == CV_16U};
  MergeEqualChannels(&image.map);
  return image;
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

// T: uint8_t or uint16_t; throws for anything but a gray picture of such
// numbers.
template <typename T>
Image<T> ReadGray(const std::filesystem::path& path) {
  const cv::Mat pixels =
      DecodePicture(ReadFileBytes(path), cv::IMREAD_UNCHANGED);
  if (pixels.type() != cv::DataType<T>::type || pixels.empty()) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "is not a picture with one channel of " +
                          std::to_string(8 * sizeof(T)) + " bits",
                      "refine the workspace again");
  }
  auto image = Image<T>::Uninitialized(pixels.cols, pixels.rows);
  pixels.copyTo(cv::Mat(pixels.rows, pixels.cols, pixels.type(), image.Data()));
  return image;
}

}  // namespace

bool IsDepthImageName(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 7> kExtensions = {
      ".png", ".exr", ".tif", ".tiff", ".pfm", ".npy", ".npz"};
  return std::ranges::find(kExtensions, LowerExtension(path)) !=
         kExtensions.end();
}

DepthImage ParseDepthImage(std::span<const uint8_t> bytes,
                           const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".pfm"   ? ParsePfm(bytes, path.string())
         : extension == ".npy" ? ParseNpy(bytes, path.string())
         : extension == ".npz" ? ParseNpz(bytes, path.string())
                               : ParsePicture(bytes, path.string());
}

FloatMap ParseNormalImage(std::span<const uint8_t> bytes,
                          const std::filesystem::path& path) {
  DepthImage normals;
  float max_value = 65535.f;
  const std::string extension = LowerExtension(path);
  if (extension == ".pfm" || extension.starts_with(".np")) {
    normals = ParseDepthImage(bytes, path);
  } else {
    const cv::Mat pixels = DecodeMap(bytes, path.string());
    normals = {ToFloatMap(pixels), pixels.depth() <= CV_16U};
    max_value = pixels.depth() == CV_8U ? 255.f : max_value;
  }
  if (normals.map.channels != 3) {
    throw Unsupported(path.string(),
                      "not a map of normals, which has three channels",
                      "save normals as PNG in colors, or as EXR, TIFF, PFM or "
                      "NPY of floats");
  }
  if (normals.is_integer) {
    DecodeIntegers(max_value, &normals.map.values);
  }
  return std::move(normals.map);
}

std::string NpyHeader(const std::string& type, const std::string& shape) {
  constexpr size_t kSize = 128;
  constexpr size_t kTextBegin = 10;
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(kSize - kTextBegin);
  header += '\0';
  header += "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" +
            shape + "), }";
  header.resize(kSize - 1, ' ');
  return header + '\n';
}

Image<uint8_t> ReadGrayPng(const std::filesystem::path& path) {
  return ReadGray<uint8_t>(path);
}

Image<uint16_t> ReadGray16Png(const std::filesystem::path& path) {
  return ReadGray<uint16_t>(path);
}

void PutSigmaMap(const Image<uint16_t>& halves, AtomicFile* file) {
  std::ostream& stream = file->Stream();
  stream << NpyHeader(
      "<f2",
      std::to_string(halves.Height()) + ", " + std::to_string(halves.Width()));
  stream.write(
      reinterpret_cast<const char*>(halves.Data()),
      static_cast<std::streamsize>(halves.NumPixels() * sizeof(uint16_t)));
}

Image<float> ReadSigmaMap(const std::filesystem::path& path) {
  const FloatMap map = ParseNpy(ReadFileBytes(path), path.string()).map;
  Image<float> sigma(map.width, map.height);
  const bool is_valid =
      map.channels == 1 && std::ranges::all_of(map.values, [](float value) {
        return std::isfinite(value) && !std::signbit(value);
      });
  if (!is_valid) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "not a sigma map: a value is negative or not finite",
                      "refine the workspace again");
  }
  std::ranges::copy(map.values, sigma.begin());
  return sigma;
}

}  // namespace tsar
