// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/masks_and_labels.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/io/photo.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaskAdvice =
    "write it as a PNG file, black where the image is to be ignored";
constexpr const char* kLabelAdvice =
    "write it as a PNG file of one channel with 8 or 16 bits, a number for "
    "each segment and 0 for none";

// The naming scheme of one kind of files in a folder.
struct FileNames {
  std::string noun;  // Such as "mask", whose plural ends in s.
  // Finds the file of an image; empty if there is none.
  fs::path (*find)(const fs::path& folder, const std::string& image);
  // The possible names of an image's file, for messages.
  std::string (*describe)(const std::string& image);
};

std::vector<fs::path> FindFilesOfImages(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const FileNames& names,
    const std::string& option) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no such folder of " + names.noun + "s",
                      "check " + option);
  }
  std::vector<fs::path> paths;
  bool has_any = false;
  for (const std::string& name : image_names) {
    paths.push_back(names.find(folder, name));
    has_any = has_any || !paths.back().empty();
  }
  if (!has_any) {
    const std::string example = image_names.empty()
                                    ? ""
                                    : "; that of " + image_names.front() +
                                          " would be " +
                                          names.describe(image_names.front());
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "holds no " + names.noun + " of any image" + example,
                      "check " + option);
  }
  return paths;
}

fs::path FindMask(const fs::path& folder, const std::string& name) {
  constexpr std::string_view kExtension = ".png";
  fs::path mask = folder / (name + ".png");
  if (Exists(mask)) {
    return mask;
  }
  mask = folder / name;
  const bool is_png =
      name.size() > kExtension.size() && FoldedCase(name).ends_with(kExtension);
  return is_png && Exists(mask) ? mask : fs::path();
}

fs::path FindLabelImage(const fs::path& folder, const std::string& name) {
  const fs::path full = folder / (name + ".png");
  const fs::path without_extension =
      fs::path(folder / name).replace_extension(".png");
  return Exists(full)                ? full
         : Exists(without_extension) ? without_extension
                                     : fs::path();
}

// The texts of messages about a PNG file, unabridged, so that a search finds
// them.
struct PngWords {
  const char* noun;
  const char* no_png;   // For another format.
  const char* damaged;  // For one that breaks off or cannot be decoded.
  const char* advice;   // How to write one.
};

constexpr PngWords kMaskWords = {"mask",
                                 "the mask is no PNG file",
                                 "the mask is damaged or breaks off",
                                 kMaskAdvice};
constexpr PngWords kLabelWords = {"label image",
                                  "the label image is no PNG file",
                                  "the label image is damaged or breaks off",
                                  kLabelAdvice};

// An open PNG file; see PictureInput for more errors.
class PngInput {
 public:
  // Throws Error kCorrupt if it is no PNG file.
  PngInput(const fs::path& path, const PngWords& words)
      : words_(words), file_(path, words.noun, words.advice) {
    const std::optional<PngHeader> header =
        ReadPngHeader(file_.Read(0, kNumHeadBytes));
    if (!header) {
      throw Error::File(
          ErrorCode::kCorrupt, Name(), words_.no_png, words_.advice);
    }
    header_ = *header;
  }

  const std::string& Name() const { return file_.Name(); }
  const PngHeader& Header() const { return header_; }
  RasterSize Size() const {
    return {static_cast<int>(header_.width), static_cast<int>(header_.height)};
  }

  // Whether the end of the file is that of a complete one.
  bool EndsAsWhole() {
    const uint64_t tail = file_.Size() - kNumTailBytes;
    return EndsInMarker(file_.Read(0, kNumHeadBytes),
                        file_.Read(tail, kNumTailBytes));
  }

  // mode: that of cv::imdecode.
  cv::Mat Decode(int mode) {
    cv::Mat pixels = DecodePicture(file_.ReadAll(), mode);
    if (pixels.empty()) {
      throw Error::File(
          ErrorCode::kCorrupt, Name(), words_.damaged, "write it again");
    }
    return pixels;
  }

 private:
  const PngWords& words_;
  PictureInput file_;
  PngHeader header_;
};

bool HasSize(const PngHeader& header, const RasterSize& size) {
  return header.width == size.width && header.height == size.height;
}

// Throws if, by its header, the file is no mask for an image of these sizes.
void RequireMask(const MaskSizes& sizes, const PngInput& file) {
  if (!HasSize(file.Header(), sizes.image) &&
      !HasSize(file.Header(), sizes.maps)) {
    const bool has_own_maps = sizes.maps.width != sizes.image.width ||
                              sizes.maps.height != sizes.image.height;
    throw Error::File(
        ErrorCode::kMismatch,
        file.Name(),
        "the mask has " + ToString(file.Size()) +
            " pixels, its undistorted image " + ToString(sizes.image) +
            (has_own_maps ? ", and its maps " + ToString(sizes.maps) : ""),
        "masks of the photos do not fit: undistort them with "
        "image_undistorter, as docs/guide.md tells under Masks");
  }
}

Image<uint8_t> DecodeMask(PngInput* file) {
  const cv::Mat pixels =
      file->Decode(cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  Image<uint8_t> mask(pixels.cols, pixels.rows);
  cv::Mat is_black(pixels.rows, pixels.cols, CV_8UC1, mask.Data());
  cv::compare(pixels, 0, is_black, cv::CMP_EQ);
  is_black &= 1;
  return mask;
}

bool HasAspectOf(const RasterSize& size, const RasterSize& image) {
  // The largest relative error: segmentation programs scale images to sizes of
  // their own.
  constexpr double kMaxAspectError = 0.02;
  const double ratio = static_cast<double>(size.width) * image.height /
                       (static_cast<double>(size.height) * image.width);
  return std::max(ratio, 1.0 / ratio) <= 1.0 + kMaxAspectError ||
         HasShapeOf(size, image);
}

// Throws if, by its header, the file holds no segments of an image of this
// size.
void RequireLabels(const RasterSize& image, const PngInput& file) {
  if (!file.Header().is_gray) {
    throw Error::File(ErrorCode::kUnsupported,
                      file.Name(),
                      "the label image has colors or transparency, which "
                      "are no numbers of segments",
                      kLabelAdvice);
  }
  const RasterSize size = file.Size();
  if (size.width <= 0 || size.height <= 0 || !HasAspectOf(size, image)) {
    throw Error::File(
        ErrorCode::kMismatch,
        file.Name(),
        "the label image has " + ToString(size) +
            " pixels, which is not the shape of its undistorted image of " +
            ToString(image),
        "segment the undistorted images, in the workspace's folder images");
  }
}

Image<uint16_t> DecodeLabels(PngInput* file) {
  const cv::Mat pixels = file->Decode(cv::IMREAD_UNCHANGED);
  Image<uint16_t> labels(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, CV_16UC1, labels.Data());
  pixels.convertTo(target, CV_16U);
  const int side = std::max(labels.Width(), labels.Height());
  return ResizeNearest<uint16_t>(
      labels,
      ReducedLength(labels.Width(), side, kMaxLabelImageSide),
      ReducedLength(labels.Height(), side, kMaxLabelImageSide));
}

}  // namespace

void RequireNoImageFolder(const fs::path& folder,
                          const fs::path& images,
                          const std::string& content,
                          const std::string& option) {
  std::error_code error;
  if (fs::equivalent(folder, images, error)) {
    throw Error::File(ErrorCode::kBadOption,
                      folder.string(),
                      "is the folder of the images",
                      "give that of their " + content + " as " + option);
  }
}

std::vector<fs::path> FindImageMasks(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option) {
  const auto describe = [](const std::string& name) { return name + ".png"; };
  return FindFilesOfImages(
      folder, image_names, {"mask", &FindMask, describe}, option);
}

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

Image<uint8_t> ReadImageMask(const fs::path& path, const MaskSizes& sizes) {
  PngInput file(path, kMaskWords);
  RequireMask(sizes, file);
  return DecodeMask(&file);
}

Image<uint16_t> ReadLabelImage(const fs::path& path, const RasterSize& image) {
  PngInput file(path, kLabelWords);
  RequireLabels(image, file);
  return DecodeLabels(&file);
}

void CheckImageMask(const fs::path& path, const MaskSizes& sizes) {
  PngInput file(path, kMaskWords);
  RequireMask(sizes, file);
  if (!file.EndsAsWhole()) {
    // Data may have been appended after the end.
    DecodeMask(&file);
  }
}

int64_t CheckLabelImage(const fs::path& path, const RasterSize& image) {
  PngInput file(path, kLabelWords);
  RequireLabels(image, file);
  if (!file.EndsAsWhole()) {
    // Data may have been appended after the end.
    DecodeLabels(&file);
  }
  return file.Header().width * file.Header().height;
}

Image<uint8_t> ResizeMask(const Image<uint8_t>& mask, const RasterSize& size) {
  if (mask.Width() == size.width && mask.Height() == size.height) {
    return mask;
  }
  // The half-open range of pixels of `from` that pixel i of `to` covers.
  const auto covered = [](int64_t i, int64_t from, int64_t to) {
    return std::pair(static_cast<int>(i * from / to),
                     static_cast<int>(((i + 1) * from + to - 1) / to));
  };
  Image<uint8_t> resized(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    const auto [begin_y, end_y] = covered(y, mask.Height(), size.height);
    for (int x = 0; x < size.width; ++x) {
      const auto [begin_x, end_x] = covered(x, mask.Width(), size.width);
      for (int j = begin_y; j < end_y; ++j) {
        const uint8_t* row = &mask(0, j);
        if (std::any_of(row + begin_x, row + end_x, [](uint8_t value) {
              return value != 0;
            })) {
          resized(x, y) = 1;
          break;
        }
      }
    }
  }
  return resized;
}

}  // namespace tsar
