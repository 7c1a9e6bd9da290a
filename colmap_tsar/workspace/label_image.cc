// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/label_image.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/workspace/photo_format.h"
#include "colmap_tsar/workspace/picture_input.h"
#include "colmap_tsar/workspace/png.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

namespace tsar {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<uint8_t>;

constexpr const char* kAdvice =
    "write it as a PNG file of one channel with 8 or 16 bits, a number for "
    "each segment and 0 for none";
// Of the longer side to the shorter one: programs for segmentation scale images
// to sizes of their own.
constexpr double kMaxAspectError = 0.02;

fs::path FindLabelImage(const fs::path& folder, const std::string& name) {
  const fs::path full = folder / (name + ".png");
  const fs::path without_extension =
      fs::path(folder / name).replace_extension(".png");
  return Exists(full)                ? full
         : Exists(without_extension) ? without_extension
                                     : fs::path();
}

bool HasAspectOf(const RasterSize& size, const RasterSize& image) {
  const double ratio = static_cast<double>(size.width) * image.height /
                       (static_cast<double>(size.height) * image.width);
  return std::max(ratio, 1.0 / ratio) <= 1.0 + kMaxAspectError ||
         HasShapeOf(size, image);
}

template <typename T>
Image<uint16_t> Reduce(const Image<T>& labels) {
  const double scale = std::min(1.0,
                                static_cast<double>(kMaxLabelImageSide) /
                                    std::max(labels.Width(), labels.Height()));
  const auto reduced = [scale](int side) {
    return std::max(1, static_cast<int>(std::lround(side * scale)));
  };
  return ResizeNearest<uint16_t>(
      labels, reduced(labels.Width()), reduced(labels.Height()));
}

class LabelFile {
 public:
  explicit LabelFile(const fs::path& path)
      : file_(path, {"label image", kAdvice, kAdvice}) {}

  // Throws where the header tells that it holds no segments of an image of this
  // size.
  PngHeader RequireFit(const RasterSize& image) {
    const Bytes head = file_.ReadHead(kPngHeadSize);
    const std::optional<PngHeader> header = ReadPngHeader(head);
    if (!header) {
      if (FormatOf(head) == PhotoFormat::kPng) {
        throw Damaged("its header is not whole");
      }
      throw Error::File(ErrorCode::kCorrupt,
                        file_.Name(),
                        "the label image is no PNG file",
                        kAdvice);
    }
    if (!header->is_gray) {
      throw Error::File(ErrorCode::kUnsupported,
                        file_.Name(),
                        "the label image has colours or transparency, which "
                        "are no numbers of segments",
                        kAdvice);
    }
    const RasterSize size = {static_cast<int>(header->width),
                             static_cast<int>(header->height)};
    if (size.width <= 0 || size.height <= 0) {
      throw Damaged("its header is not whole");
    }
    if (!HasAspectOf(size, image)) {
      throw Error::File(
          ErrorCode::kMismatch,
          file_.Name(),
          "the label image has " + ToString(size) +
              " pixels, which is not the shape of its undistorted image of " +
              ToString(image),
          "segment the undistorted images, in the workspace's folder images");
    }
    return *header;
  }

  bool EndsAsWhole() {
    constexpr uint64_t kTailBytes = 16;
    return EndsInMarker(PhotoFormat::kPng, file_.ReadTail(kTailBytes));
  }

  Image<uint16_t> Decode(const PngHeader& header) {
    const Bytes bytes = file_.ReadAll();
    const PngError error = [&](const std::string& defect) {
      return Damaged(defect);
    };
    return header.bits_per_channel > 8 ? Reduce(DecodeGray16Png(bytes, error))
                                       : Reduce(DecodeGrayPng(bytes, error));
  }

 private:
  Error Damaged(const std::string& what) const {
    return Error::File(ErrorCode::kCorrupt,
                       file_.Name(),
                       "the label image is damaged: " + what,
                       "write it again");
  }

  PictureInput file_;
};

}  // namespace

std::vector<fs::path> FindLabelImages(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no such folder of label images",
                      "check " + option);
  }
  std::vector<fs::path> paths;
  bool has_any = false;
  for (const std::string& name : image_names) {
    paths.push_back(FindLabelImage(folder, name));
    has_any = has_any || !paths.back().empty();
  }
  if (!has_any) {
    const std::string example = image_names.empty()
                                    ? ""
                                    : "; that of " + image_names.front() +
                                          " would be " + image_names.front() +
                                          ".png or " +
                                          fs::path(image_names.front())
                                              .replace_extension(".png")
                                              .string();
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "holds no label image of any image" + example,
                      "check " + option);
  }
  return paths;
}

Image<uint16_t> ReadLabelImage(const fs::path& path, const RasterSize& image) {
  LabelFile file(path);
  return file.Decode(file.RequireFit(image));
}

int64_t CheckLabelImage(const fs::path& path, const RasterSize& image) {
  LabelFile file(path);
  const PngHeader header = file.RequireFit(image);
  if (!file.EndsAsWhole()) {
    // Something may have been added behind the end.
    file.Decode(header);
  }
  return int64_t{header.width} * int64_t{header.height};
}

}  // namespace tsar
