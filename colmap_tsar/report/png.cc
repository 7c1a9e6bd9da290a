// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/png.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/picture_file.h"

#include <opencv2/imgproc.hpp>

namespace tsar {

void WritePng(const ContainedPath& path, const Image<Rgb>& image) {
  const cv::Mat rgb(
      image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  AtomicFile file(path);
  PutPicture(bgr, ".png", path, &file);
  file.Commit();
}

}  // namespace tsar
