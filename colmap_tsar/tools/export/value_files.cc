// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/value_files.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/map_files.h"

#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float));

template <typename T>
void Write(const ContainedPath& path,
           const Image<T>& values,
           const std::string& type,
           const std::string& more_sides) {
  const std::string header =
      NpyHeader(type,
                std::to_string(values.Height()) + ", " +
                    std::to_string(values.Width()) + more_sides);
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream().write(header.data(),
                      static_cast<std::streamsize>(header.size()));
  file.Stream().write(
      reinterpret_cast<const char*>(values.Data()),
      static_cast<std::streamsize>(values.NumPixels() * sizeof(T)));
  file.Commit();
}

// OpenCV takes blue first.
template <typename T>
Image<T> Reversed(const Image<T>& values) {
  Image<T> reversed = values;
  for (T& value : reversed) {
    if constexpr (std::is_same_v<T, Vec3f>) {
      std::swap(value.x, value.z);
    } else {
      std::swap(value.r, value.b);
    }
  }
  return reversed;
}

// Wraps the image's memory; encoding only reads it.
template <typename T>
cv::Mat AsMatrix(const Image<T>& values, int type) {
  return cv::Mat(
      values.Height(), values.Width(), type, const_cast<T*>(values.Data()));
}

// Encodes pixels; empty if OpenCV cannot.
std::vector<uchar> EncodeExr(const cv::Mat& pixels) {
  try {
    std::vector<uchar> bytes;
    if (cv::imencode(".exr", pixels, bytes)) {
      return bytes;
    }
  } catch (const std::exception&) {  // OpenEXR has exceptions of its own.
  }
  return {};
}

bool AreSame(const cv::Mat& first, const cv::Mat& second) {
  return first.size() == second.size() && first.type() == second.type() &&
         first.isContinuous() && second.isContinuous() &&
         std::memcmp(
             first.data, second.data, first.total() * first.elemSize()) == 0;
}

void WritePng(const ContainedPath& path, const cv::Mat& pixels) {
  CreateFolders(path.Parent());
  AtomicFile file(path);
  PutPicture(pixels, ".png", path, &file);
  file.Commit();
}

// OpenCV encodes EXR by way of a temporary file and does not report a full
// disk; so the result is checked.
void WriteExr(const ContainedPath& path, const cv::Mat& pixels) {
  const std::vector<uchar> bytes = EncodeExr(pixels);
  cv::Mat read;
  try {
    if (!bytes.empty()) {
      read = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    }
  } catch (const std::exception&) {
    read.release();
  }
  if (!AreSame(read, pixels)) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be encoded as EXR",
                      "make room in the folder of temporary files (/tmp)");
  }
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
  file.Commit();
}

}  // namespace

void WriteArray(const ContainedPath& path, const Image<float>& values) {
  Write(path, values, "<f4", "");
}

void WriteArray(const ContainedPath& path, const Image<Vec3f>& values) {
  Write(path, values, "<f4", ", 3");
}

void WriteArray(const ContainedPath& path, const Image<uint8_t>& values) {
  Write(path, values, "|u1", "");
}

void WriteArray(const ContainedPath& path, const Image<uint16_t>& values) {
  Write(path, values, "<u2", "");
}

void WritePngFile(const ContainedPath& path, const Image<uint8_t>& values) {
  WritePng(path, AsMatrix(values, CV_8UC1));
}

void WritePngFile(const ContainedPath& path, const Image<uint16_t>& values) {
  WritePng(path, AsMatrix(values, CV_16UC1));
}

void WritePngFile(const ContainedPath& path, const Image<Rgb>& values) {
  const Image<Rgb> reversed = Reversed(values);
  WritePng(path, AsMatrix(reversed, CV_8UC3));
}

void WritePngFile(const ContainedPath& path, const Image<Rgb16>& values) {
  const Image<Rgb16> reversed = Reversed(values);
  WritePng(path, AsMatrix(reversed, CV_16UC3));
}

void WriteExrFile(const ContainedPath& path, const Image<float>& values) {
  WriteExr(path, AsMatrix(values, CV_32FC1));
}

void WriteExrFile(const ContainedPath& path, const Image<Vec3f>& values) {
  const Image<Vec3f> reversed = Reversed(values);
  WriteExr(path, AsMatrix(reversed, CV_32FC3));
}

void RequireExr() {
  // Builds of OpenCV with OpenEXR may still require this variable.
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  const Image<float> values(1, 1, 1.f);
  if (EncodeExr(AsMatrix(values, CV_32FC1)).empty()) {
    throw Error(ErrorCode::kUnsupported,
                "this build of OpenCV cannot write EXR; give " +
                    OptionName("format") + " npy");
  }
}

}  // namespace tsar
