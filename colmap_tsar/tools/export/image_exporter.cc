// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/image_exporter.h"

#include "colmap_tsar/base/text_stream.h"

namespace tsar {

std::string ShareOfDepths(int64_t count, int64_t num_depths) {
  TextStream text;
  text.precision(3);
  text << 100.0 * static_cast<double>(count) / static_cast<double>(num_depths)
       << " % of the depths";
  return text.str();
}

}  // namespace tsar
