// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/label_image.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/io/files_of_images.h"
#include "colmap_tsar/io/png.h"
#include "colmap_tsar/io/png_input.h"

#include <algorithm>

namespace tsar {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<uint8_t>;

constexpr const char* kAdvice =
    "write it as a PNG file of one channel with 8 or 16 bits, a number for "
    "each segment and 0 for none";
// The largest relative error of the aspect ratio: segmentation programs scale
// images to sizes of their own.
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
  const int side = std::max(labels.Width(), labels.Height());
  return ResizeNearest<uint16_t>(
      labels,
      ReducedLength(labels.Width(), side, kMaxLabelImageSide),
      ReducedLength(labels.Height(), side, kMaxLabelImageSide));
}

class LabelFile {
 public:
  explicit LabelFile(const fs::path& path)
      : file_(path,
              {"label image",
               "the label image is no PNG file",
               "the label image is damaged: ",
               kAdvice}) {}

  // Throws if, by its header, the file holds no segments of an image of this
  // size.
  PngHeader RequireFit(const RasterSize& image) {
    const PngHeader header = file_.ReadHeader();
    if (!header.is_gray) {
      throw Error::File(ErrorCode::kUnsupported,
                        file_.Name(),
                        "the label image has colors or transparency, which "
                        "are no numbers of segments",
                        kAdvice);
    }
    const RasterSize size = {static_cast<int>(header.width),
                             static_cast<int>(header.height)};
    if (size.width <= 0 || size.height <= 0) {
      throw file_.Damaged("its header is not whole");
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
    return header;
  }

  bool EndsAsWhole() { return file_.EndsAsWhole(); }

  Image<uint16_t> Decode(const PngHeader& header) {
    const Bytes bytes = file_.ReadAll();
    const PngError error = [&](const std::string& defect) {
      return file_.Damaged(defect);
    };
    return header.bits_per_channel > 8 ? Reduce(DecodeGray16Png(bytes, error))
                                       : Reduce(DecodeGrayPng(bytes, error));
  }

 private:
  PngInput file_;
};

}  // namespace

std::vector<fs::path> FindLabelImages(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option) {
  const auto describe = [](const std::string& name) {
    return name + ".png or " +
           fs::path(name).replace_extension(".png").string();
  };
  return FindFilesOfImages(
      folder, image_names, {"label image", &FindLabelImage, describe}, option);
}

Image<uint16_t> ReadLabelImage(const fs::path& path, const RasterSize& image) {
  LabelFile file(path);
  return file.Decode(file.RequireFit(image));
}

int64_t CheckLabelImage(const fs::path& path, const RasterSize& image) {
  LabelFile file(path);
  const PngHeader header = file.RequireFit(image);
  if (!file.EndsAsWhole()) {
    // Data may have been appended after the end.
    file.Decode(header);
  }
  return int64_t{header.width} * int64_t{header.height};
}

}  // namespace tsar
