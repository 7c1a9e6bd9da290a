// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/png.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {

void WritePng(const ContainedPath& path, const Image<Rgb>& image) {
  const cv::Mat rgb(
      image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the picture cannot be encoded as PNG",
                      "use an OpenCV that was built with PNG");
  }
  AtomicFile file(path);
  file.Stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
  file.Commit();
}

}  // namespace tsar
