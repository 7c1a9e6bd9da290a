// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <functional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

// Writes a PNG file that is black where is_masked(x, y) says so, otherwise
// white.
inline void WriteMask(const std::filesystem::path& path,
                      int width,
                      int height,
                      const std::function<bool(int x, int y)>& is_masked) {
  cv::Mat pixels(height, width, CV_8UC1, cv::Scalar(255));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (is_masked(x, y)) {
        pixels.at<uchar>(y, x) = 0;
      }
    }
  }
  std::filesystem::create_directories(path.parent_path());
  ASSERT_TRUE(cv::imwrite(path.string(), pixels));
}

}  // namespace tsar
