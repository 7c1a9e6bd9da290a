// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/companion_maps.h"
#include "colmap_tsar/io/depth_image.h"

#include <cstdlib>

#include "tests/fuzz/fuzz_target.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

template <const char* kName>
void ReadDepthImage(std::span<const uint8_t> input) {
  Accepts([&] { ParseDepthImage(input, kName); });
  Accepts([&] { ParseNormalImage(input, kName); });
}

void ReadGrayMap(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("map.png", input);
  Accepts([&] { ReadGrayPng(path); });
  Accepts([&] { ReadGray16Png(path); });
}

std::string Encoded(const std::string& extension, const cv::Mat& pixels) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  std::vector<uchar> bytes;
  cv::imencode(extension, pixels, bytes);
  return std::string(bytes.begin(), bytes.end());
}

std::vector<std::string> MakeNpySeeds() {
  std::vector<std::string> seeds;
  for (const auto& [type, num_bytes] : {std::pair("<f4", 24),
                                        std::pair(">f8", 48),
                                        std::pair("<f2", 12),
                                        std::pair("<u2", 12)}) {
    std::string header = "{'descr': '" + std::string(type) +
                         "', 'fortran_order': False, 'shape': (2, 3), }\n";
    std::string bytes("\x93NUMPY\x01\x00", 8);
    AppendValue(static_cast<uint16_t>(header.size()), &bytes);
    seeds.push_back(bytes + header +
                    std::string(static_cast<size_t>(num_bytes), '\x3f'));
  }
  return seeds;
}

std::vector<std::string> MakePfmSeeds() {
  return {"Pf\n3 2\n-1.0\n" + std::string(24, '\x3f'),
          "PF 2 1 1\n" + std::string(24, '\x3f')};
}

std::vector<std::string> MakePngSeeds() {
  return {Encoded(".png", cv::Mat(4, 5, CV_16UC1, cv::Scalar(1234))),
          Encoded(".png", cv::Mat(2, 2, CV_8UC3, cv::Scalar(1, 2, 3)))};
}

std::vector<std::string> MakeTiffSeeds() {
  return {Encoded(".tiff", cv::Mat(4, 5, CV_32FC1, cv::Scalar(1.5))),
          Encoded(".tiff", cv::Mat(3, 2, CV_16UC1, cv::Scalar(1234))),
          Encoded(".tiff", cv::Mat(2, 2, CV_32FC3, cv::Scalar(1, 2, 3)))};
}

std::vector<std::string> MakeExrSeeds() {
  if (!cv::haveImageWriter("depth.exr")) {
    return {std::string("\x76\x2f\x31\x01\x02\0\0\0", 8)};
  }
  return {Encoded(".exr", cv::Mat(4, 5, CV_32FC1, cv::Scalar(1.5))),
          Encoded(".exr", cv::Mat(2, 2, CV_32FC3, cv::Scalar(1, 2, 3)))};
}

std::vector<std::string> MakeGrayPngSeeds() {
  return {Encoded(".png", cv::Mat(4, 5, CV_8UC1, cv::Scalar(4))),
          Encoded(".png", cv::Mat(4, 5, CV_16UC1, cv::Scalar(4)))};
}

constexpr char kNpyName[] = "depth.npy";
constexpr char kPfmName[] = "depth.pfm";
constexpr char kPngName[] = "depth.png";
constexpr char kTiffName[] = "depth.tiff";
constexpr char kExrName[] = "depth.exr";

}  // namespace

const FuzzTarget kNpyTarget = {"npy", &ReadDepthImage<kNpyName>, &MakeNpySeeds};
const FuzzTarget kPfmTarget = {"pfm", &ReadDepthImage<kPfmName>, &MakePfmSeeds};
const FuzzTarget kPngTarget = {"png", &ReadDepthImage<kPngName>, &MakePngSeeds};
const FuzzTarget kTiffTarget = {
    "tiff", &ReadDepthImage<kTiffName>, &MakeTiffSeeds};
const FuzzTarget kExrTarget = {"exr", &ReadDepthImage<kExrName>, &MakeExrSeeds};
const FuzzTarget kGrayPngTarget = {"gray_png", &ReadGrayMap, &MakeGrayPngSeeds};

}  // namespace tsar
