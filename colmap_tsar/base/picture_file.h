// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/input_file.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cv {
class Mat;
}

namespace tsar {

// The texts of messages about a picture.
struct PictureWords {
  std::string noun;                 // A noun such as "mask".
  std::string advice;               // For a missing or empty file.
  std::string advice_if_too_large;  // For a too large file.
};

// An open file of a picture, of at least one byte. All functions throw Error,
// naming the file: kNotFound (no such file), kIo (it cannot be read, or is no
// regular file), kCorrupt (empty), kUnsupported (2 GB or more).
class PictureInput {
 public:
  PictureInput(const std::filesystem::path& path, PictureWords words);

  const std::string& Name() const { return name_; }
  uint64_t Size() const { return file_.Size(); }

  // Read the first or the last `count` bytes, or fewer if the file is shorter.
  std::vector<uint8_t> ReadHead(uint64_t count);
  std::vector<uint8_t> ReadTail(uint64_t count);
  std::vector<uint8_t> ReadAll();

 private:
  std::vector<uint8_t> Read(uint64_t begin, uint64_t count);

  std::string name_;
  PictureWords words_;
  InputFile file_;
};

// Writes pixels (colors as BGR) to a file in a format of OpenCV: ".png",
// ".jpg". parameters: those of cv::imencode(). Throws kIo with the path if
// OpenCV was built without the format, and std::bad_alloc.
void PutPicture(const cv::Mat& pixels,
                const std::string& extension,
                const std::filesystem::path& path,
                AtomicFile* file,
                const std::vector<int>& parameters = {});

// The pixels of a file as cv::imdecode() returns them in this mode; empty if
// OpenCV cannot decode it. Throws std::bad_alloc.
cv::Mat DecodePicture(std::span<const uint8_t> bytes, int mode);

}  // namespace tsar
