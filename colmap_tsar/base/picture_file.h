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

// An open file of a picture, of at least one byte. All functions throw Error,
// naming the file: kNotFound (no such file), kIo (it cannot be read, or is no
// regular file), kCorrupt (empty).
class PictureInput {
 public:
  // noun: such as "mask"; advice: for a missing or empty file.
  PictureInput(const std::filesystem::path& path,
               const std::string& noun,
               const std::string& advice);

  const std::string& Name() const { return name_; }
  uint64_t Size() const { return file_.Size(); }

  // `count` bytes from an offset on, or fewer if the file ends before.
  std::vector<uint8_t> Read(uint64_t begin, uint64_t count);
  std::vector<uint8_t> ReadAll() { return Read(0, Size()); }

 private:
  std::string name_;
  std::string noun_;
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
// OpenCV cannot decode it, or it has 2 GB or more. Throws std::bad_alloc.
cv::Mat DecodePicture(std::span<const uint8_t> bytes, int mode);

}  // namespace tsar
