// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/write_planes.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>

namespace tsar {

const std::vector<std::string>& PlaneFormatNames() {
  static const std::vector<std::string> names = {"json", "ply", "obj", "dxf"};
  return names;
}

PlaneFormat ParsePlaneFormat(const std::string& name, const std::string& path) {
  std::string wanted = name;
  if (wanted.empty()) {
    wanted = std::filesystem::path(path).extension().string();
    wanted.erase(0, 1);
    std::transform(
        wanted.begin(), wanted.end(), wanted.begin(), [](unsigned char c) {
          return std::tolower(c);
        });
  }
  const std::vector<std::string>& names = PlaneFormatNames();
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end()) {
    throw Error(ErrorCode::kBadOption,
                name.empty()
                    ? OptionName("output_path") + ": the name " + path +
                          " does not tell the format; let it end in .json, "
                          ".ply, .obj or .dxf, or give " +
                          OptionName("format")
                    : OptionName("format") + ": '" + name +
                          "' is not known; give json, ply, obj or dxf");
  }
  return static_cast<PlaneFormat>(found - names.begin());
}

void WritePlanes(const ContainedPath& path,
                 PlaneFormat format,
                 const ExportedPlanes& planes) {
  AtomicFile file(path);
  switch (format) {
    case PlaneFormat::kJson:
      PutPlanesJson(planes, &file.Stream());
      break;
    case PlaneFormat::kPly:
      PutPlanesPly(planes, &file.Stream());
      break;
    case PlaneFormat::kObj:
      PutPlanesObj(planes, &file.Stream());
      break;
    case PlaneFormat::kDxf:
      PutPlanesDxf(planes, &file.Stream());
      break;
  }
  file.Commit();
}

}  // namespace tsar
