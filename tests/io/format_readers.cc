// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/io/format_readers.h"

#include "colmap_tsar/io/array_files.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/depth_image.h"

#include "tests/support/test_workspace.h"
#include <opencv2/imgcodecs.hpp>

namespace tsar {

std::string Int32s(const std::vector<int32_t>& numbers) {
  std::string bytes;
  for (const int32_t number : numbers) {
    Append(number, &bytes);
  }
  return bytes;
}

DmapContent SmallDmap() {
  DmapContent content;
  content.camera.width = 3;
  content.camera.height = 2;
  content.camera.fx = 4.0;
  content.camera.fy = 5.0;
  content.camera.cx = 1.5;
  content.camera.cy = 1.0;
  content.camera.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  content.camera.translation = {1, 2, 3};
  content.depth = Image<float>(3, 2);
  content.normal = Image<Vec3f>(3, 2, Vec3f{0.f, 0.6f, -0.8f});
  for (size_t i = 0; i < 6; ++i) {
    content.depth.Data()[i] = kSix[i];
  }
  return content;
}

std::string EncodedPicture(const std::string& extension, const cv::Mat& mat) {
  std::vector<uchar> bytes;
  // Without this, OpenCV writes three channels of TIFF with loss.
  constexpr int kNoCompression = 1;
  EXPECT_TRUE(cv::imencode(
      extension, mat, bytes, {cv::IMWRITE_TIFF_COMPRESSION, kNoCompression}));
  return {bytes.begin(), bytes.end()};
}
FloatMap ReadDmb(const std::string& bytes) {
  return ParseDmb(AsBytes(bytes), "some.file");
}
FloatMap ReadApd(const std::string& bytes) {
  return ParseApdMap(AsBytes(bytes), "some.file");
}
FloatMap ReadPfm(const std::string& bytes) {
  return ParsePfm(AsBytes(bytes), "some.file");
}
FloatMap ReadNpy(const std::string& bytes) {
  return ParseNpy(AsBytes(bytes), "some.file").map;
}
FloatMap ReadDmap(const std::string& bytes) {
  const Dmap dmap = ParseDmap(AsBytes(bytes), "some.file");
  return {dmap.depth.Width(), dmap.depth.Height(), 1, ValuesOf(dmap.depth)};
}
FloatMap ReadPng(const std::string& bytes) {
  return ParseDepthImage(AsBytes(bytes), "some.file.PNG").map;
}
FloatMap ReadTiff(const std::string& bytes) {
  return ParseDepthImage(AsBytes(bytes), "some.file.tif").map;
}

}  // namespace tsar
