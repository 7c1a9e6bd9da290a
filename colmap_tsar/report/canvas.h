// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/report/scaling.h"

#include <string>

#include <opencv2/core/mat.hpp>

namespace tsar {

// A picture that grows downwards while it is drawn. Positions are in pixels
// from the upper left corner; what does not fit on the width is cut off.
class Canvas {
 public:
  explicit Canvas(int width) : width_(width) {}

  // Adds a white strip below all others and returns its upper edge.
  int AddStrip(int height);

  // All of what is drawn must lie on strips.
  void Draw(const Image<Rgb>& image,
            int x,
            int y,
            int width,
            int height,
            Scaling scaling);
  void FillBox(int x, int y, int width, int height, const Rgb& color);
  // y: the middle of the line of text. Only ASCII can be drawn; all else
  // becomes '?'.
  void Write(const std::string& text, int x, int y);

  Image<Rgb> Picture() const;

 private:
  int width_;
  cv::Mat pixels_;  // CV_8UC3, red first.
};

}  // namespace tsar
