// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_masks.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/photo.h"

#include <algorithm>
#include <optional>
#include <set>
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

Error Corrupt(const fs::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt, path.string(), what, kMaskAdvice);
}

// Throws if, by its header, the file is no mask for an image of these sizes.
// Returns whether it has an alpha channel.
bool RequireMask(const fs::path& path,
                 const MaskSizes& sizes,
                 InputFile* file) {
  file->RequireOpened("mask", kMaskAdvice);
  const std::optional<PngHeader> header = ReadPngHeader(file);
  if (!header) {
    throw Corrupt(
        path,
        file->Size() == 0 ? "the file is empty" : "the mask is no PNG file");
  }
  const auto has_size = [&](const RasterSize& size) {
    return header->width == size.width && header->height == size.height;
  };
  if (!has_size(sizes.image) && !has_size(sizes.maps)) {
    const bool has_own_maps = sizes.maps.width != sizes.image.width ||
                              sizes.maps.height != sizes.image.height;
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "the mask has " + std::to_string(header->width) + " x " +
            std::to_string(header->height) + " pixels, its undistorted image " +
            ToString(sizes.image) +
            (has_own_maps ? ", and its maps " + ToString(sizes.maps) : ""),
        "masks of the photos do not fit: undistort them with "
        "image_undistorter, as docs/guide.md tells under Masks");
  }
  return header->has_alpha;
}

Image<uint8_t> DecodeMask(const fs::path& path,
                          bool has_alpha,
                          InputFile* file) {
  const auto decode = [&](int mode) {
    return DecodePicture(file->ReadBytes(0, file->Size()), mode);
  };
  const cv::Mat pixels = decode(cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  if (pixels.empty()) {
    throw Corrupt(path, "the mask is damaged or breaks off");
  }
  Image<uint8_t> mask(pixels.cols, pixels.rows);
  cv::Mat is_black(pixels.rows, pixels.cols, CV_8UC1, mask.Data());
  cv::compare(pixels, 0, is_black, cv::CMP_EQ);
  is_black &= 1;
  const auto varies = [](const cv::Mat& channel) {
    const int count = cv::countNonZero(channel);
    return count > 0 && count < static_cast<int>(channel.total());
  };
  if (has_alpha && !varies(is_black)) {
    const cv::Mat whole = decode(cv::IMREAD_UNCHANGED);
    cv::Mat alpha;
    cv::extractChannel(whole, alpha, whole.channels() - 1);
    if (varies(alpha)) {
      throw Corrupt(path, "the mask is all of one color, and transparent");
    }
  }
  return mask;
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
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no such folder of masks",
                      "check " + option);
  }
  std::vector<fs::path> paths;
  for (const std::string& name : image_names) {
    paths.push_back(FindMask(folder, name));
  }
  if (std::ranges::all_of(paths, &fs::path::empty)) {
    const std::string example =
        image_names.empty() ? ""
                            : "; that of " + image_names.front() +
                                  " would be " + image_names.front() + ".png";
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "holds no mask of any image" + example,
                      "check " + option);
  }
  return paths;
}

void WarnOfStrayMasks(const fs::path& folder,
                      const std::vector<fs::path>& masks) {
  std::set<fs::path> known;
  for (const fs::path& mask : masks) {
    known.insert(mask.lexically_normal());
  }
  std::vector<fs::path> strays;
  for (const FolderEntry& entry : ListTree({folder, {}})) {
    const fs::path path = entry.path.Path().lexically_normal();
    const std::string extension = FoldedCase(path.extension().string());
    const bool is_picture =
        extension == ".png" || extension == ".jpg" || extension == ".jpeg";
    if (is_picture && !entry.is_folder && !known.contains(path)) {
      strays.push_back(path);
    }
  }
  WarnOfStrayFiles(folder, strays);
}

Image<uint8_t> ReadImageMask(const fs::path& path, const MaskSizes& sizes) {
  InputFile file(path);
  const bool has_alpha = RequireMask(path, sizes, &file);
  return DecodeMask(path, has_alpha, &file);
}

void CheckImageMask(const fs::path& path, const MaskSizes& sizes) {
  InputFile file(path);
  const bool has_alpha = RequireMask(path, sizes, &file);
  if (has_alpha || !EndsInMarker(&file)) {
    // Data may have been appended after the end.
    DecodeMask(path, has_alpha, &file);
  }
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
