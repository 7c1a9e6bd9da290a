// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_mask.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/files_of_images.h"
#include "colmap_tsar/io/png.h"
#include "colmap_tsar/io/png_input.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<uint8_t>;

constexpr const char* kAdvice =
    "write it as a PNG file of 8 bits, black where the image is to be ignored";

bool IsPngName(const std::string& name) {
  constexpr std::string_view kExtension = ".png";
  return name.size() > kExtension.size() &&
         std::equal(kExtension.rbegin(),
                    kExtension.rend(),
                    name.rbegin(),
                    [](char expected, char c) {
                      return expected ==
                             std::tolower(static_cast<unsigned char>(c));
                    });
}

fs::path FindMask(const fs::path& folder, const std::string& name) {
  fs::path mask = folder / (name + ".png");
  if (Exists(mask)) {
    return mask;
  }
  mask = folder / name;
  return IsPngName(name) && Exists(mask) ? mask : fs::path();
}

class MaskFile {
 public:
  explicit MaskFile(const fs::path& path)
      : file_(path,
              {"mask",
               "the mask is no PNG file",
               "the mask is damaged: ",
               kAdvice}) {}

  // Throws if, by its header, the file is no mask for an image of these sizes.
  void RequireFit(const MaskSizes& sizes) {
    const PngHeader header = file_.ReadHeader();
    if (header.bits_per_channel > 8) {
      throw Error::File(ErrorCode::kUnsupported,
                        file_.Name(),
                        "the mask has " +
                            std::to_string(header.bits_per_channel) +
                            " bits per channel",
                        kAdvice);
    }
    if (!HasSize(header, sizes.image) && !HasSize(header, sizes.maps)) {
      throw Mismatch(header, sizes);
    }
  }

  bool EndsAsWhole() { return file_.EndsAsWhole(); }

  Image<uint8_t> Decode() {
    const Bytes bytes = file_.ReadAll();
    Image<uint8_t> mask = DecodeGrayPng(bytes, [&](const std::string& defect) {
      return file_.Damaged(defect);
    });
    for (uint8_t& value : mask) {
      value = value == 0 ? 1 : 0;
    }
    return mask;
  }

 private:
  static bool HasSize(const PngHeader& header, const RasterSize& size) {
    return int64_t{header.width} == size.width &&
           int64_t{header.height} == size.height;
  }

  Error Mismatch(const PngHeader& header, const MaskSizes& sizes) const {
    const bool has_own_maps = sizes.maps.width != sizes.image.width ||
                              sizes.maps.height != sizes.image.height;
    return Error::File(
        ErrorCode::kMismatch,
        file_.Name(),
        "the mask has " + std::to_string(header.width) + " x " +
            std::to_string(header.height) + " pixels, its undistorted image " +
            ToString(sizes.image) +
            (has_own_maps ? ", and its maps " + ToString(sizes.maps) : ""),
        "masks of the photos do not fit: undistort them with "
        "image_undistorter, as docs/guide.md tells under Masks");
  }

  PngInput file_;
};

}  // namespace

std::vector<fs::path> FindImageMasks(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option) {
  return FindFilesOfImages(
      folder,
      image_names,
      {"mask",
       &FindMask,
       [](const std::string& name) { return name + ".png"; }},
      option);
}

Image<uint8_t> ReadImageMask(const fs::path& path, const MaskSizes& sizes) {
  MaskFile file(path);
  file.RequireFit(sizes);
  return file.Decode();
}

void CheckImageMask(const fs::path& path, const MaskSizes& sizes) {
  MaskFile file(path);
  file.RequireFit(sizes);
  if (!file.EndsAsWhole()) {
    // Data may have been appended after the end.
    file.Decode();
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
