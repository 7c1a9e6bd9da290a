// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <filesystem>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Writes a DXF file (R12, ASCII), a sequence of pairs of lines: a group code
// and its value. The caller puts the entities.
class DxfWriter {
 public:
  // Begins the file: $INSUNITS (meters or none), a layer for each class.
  DxfWriter(bool in_meters, std::ostream* out);
  // Ends the file.
  void Finish();

  void Put(int code, const std::string& value);
  void Put(int code, int value) { Put(code, std::to_string(value)); }
  // Writes a point with codes code, code + 10 and code + 20.
  void PutPoint(int code, const Eigen::Vector3d& point);

  static std::string LayerName(PlaneClass plane_class);

 private:
  void BeginSection(const char* name);
  void EndSection() { Put(0, "ENDSEC"); }
  void PutLayers();

  std::ostream* out_;
};

// A convex face in the world frame: its three or four corners, counterclockwise
// against the normal.
using PlaneFace = std::vector<Eigen::Vector3d>;

// Cuts the polygons of a plane into faces, along its second axis.
std::vector<PlaneFace> MakeFaces(const ExportedPlane& plane);

// Writers of the formats, which docs/planes.md describes; the same planes
// become the same bytes.
using PlanesWriter = void (*)(const ExportedPlanes& planes, std::ostream* out);
// All members.
void PutPlanesJson(const ExportedPlanes& planes, std::ostream* out);
// Faces in groups, plane_ID_CLASS.
void PutPlanesObj(const ExportedPlanes& planes, std::ostream* out);
// R12 ASCII: faces (3DFACE) and outlines (POLYLINE) in a layer for each class.
void PutPlanesDxf(const ExportedPlanes& planes, std::ostream* out);

// Whether a file holds a plane: JSON alone has those without faces.
bool IsWritten(const ExportedPlane& plane, PlanesWriter writer);

// The writer with the extension of the path among these. option: that gives the
// path. Throws Error kBadOption.
template <typename Writer>
Writer WriterFor(const std::filesystem::path& path,
                 const std::string& option,
                 const std::vector<std::pair<std::string, Writer>>& writers) {
  const std::string extension = FoldedCase(path.extension().string());
  std::string extensions;
  for (const auto& [known, writer] : writers) {
    if (extension == known) {
      return writer;
    }
    extensions += (extensions.empty() ? "" : " or ") + known;
  }
  throw Error(ErrorCode::kBadOption,
              OptionName(option) + ": the name " + path.string() +
                  " does not tell the format; let it end in " + extensions);
}
// Of the option output_path.
PlanesWriter PlanesWriterFor(const std::filesystem::path& path);

// Writes atomically; errors as AtomicFile.
template <typename Content>
void WriteFile(const std::filesystem::path& path,
               void (*put)(const Content& content, std::ostream* out),
               const Content& content) {
  AtomicFile file(UserPath(path));
  put(content, &file.Stream());
  file.Commit();
}

}  // namespace tsar
