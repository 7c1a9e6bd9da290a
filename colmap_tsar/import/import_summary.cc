// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/import_summary.h"

#include "colmap_tsar/base/printable.h"

#include <algorithm>
#include <cstdio>

namespace tsar {
namespace {

std::string Text(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

}  // namespace

void PrintSummary(const ImportSummary& summary, std::ostream& out) {
  out << summary.num_images << " images: " << summary.num_imported
      << " imported, " << summary.num_images - summary.num_imported
      << " without a map\n";
  if (summary.num_without_image > 0) {
    out << summary.num_without_image
        << " maps are of images that are not in the workspace\n";
  }
  out << "Normals came with " << summary.num_with_normals
      << " of them, and are computed from depth otherwise\n";
  if (summary.num_with_costs > 0) {
    out << "Costs came with " << summary.num_with_costs << "\n";
  }
  const double share = summary.num_pixels > 0
                           ? 100.0 *
                                 static_cast<double>(summary.num_with_depth) /
                                 static_cast<double>(summary.num_pixels)
                           : 0.0;
  out << "Pixels with depth: " << Text("%.1f", share) << " %\n";
  if (summary.scale.num_images > 0) {
    out << (summary.has_own_scales
                ? "Before scaling, depth over that of the sparse points: "
                  "median "
                : "Depth over that of the sparse points: median ")
        << Text("%.3f", summary.scale.median) << " ("
        << Text("%.3f", summary.scale.smallest) << " to "
        << Text("%.3f", summary.scale.largest) << " over "
        << summary.scale.num_images << " images)\n";
  }
  if (summary.far > 0.f && summary.sparse_far > 0.f) {
    out << "Depths from " << Text("%.4g", summary.near) << " to "
        << Text("%.4g", summary.far) << ", sparse points from "
        << Text("%.4g", summary.sparse_near) << " to "
        << Text("%.4g", summary.sparse_far) << "\n";
  }
  constexpr size_t kMaxWarnings = 20;
  const size_t num_shown = std::min(summary.warnings.size(), kMaxWarnings);
  for (size_t i = 0; i < num_shown; ++i) {
    out << "WARNING: " << Printable(summary.warnings[i]) << "\n";
  }
  if (num_shown < summary.warnings.size()) {
    out << "WARNING: and " << summary.warnings.size() - num_shown
        << " more like these\n";
  }
  out << "Next: colmap_tsar tsar_refine --workspace_path "
      << ShellWord(Printable(summary.workspace_path.string()))
      << " --input_type " << ToString(summary.type) << "\n";
}

}  // namespace tsar
