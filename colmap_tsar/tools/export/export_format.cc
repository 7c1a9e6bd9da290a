// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/export_format.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <cstddef>

namespace tsar {

const std::vector<std::string>& ExportFormatNames() {
  static const std::vector<std::string> names = {
      "npy", "exr", "png16", "nerfstudio", "3dgs"};
  return names;
}

std::string ToString(ExportFormat format) {
  return ExportFormatNames()[static_cast<size_t>(format)];
}

ExportFormat ParseExportFormat(const std::string& name) {
  const std::vector<std::string>& names = ExportFormatNames();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("format") +
            (name.empty() ? " is missing" : ": '" + name + "' is not known") +
            "; give npy, exr, png16, nerfstudio or 3dgs");
  }
  return static_cast<ExportFormat>(found - names.begin());
}

}  // namespace tsar
