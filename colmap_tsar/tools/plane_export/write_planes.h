// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <ostream>
#include <string>
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

// docs/planes.md describes the files.
enum class PlaneFormat {
  kJson,  // All members.
  kObj,   // Faces in groups, plane_ID_CLASS.
  kDxf,   // R12 ASCII: faces (3DFACE) and outlines (POLYLINE) in a layer for
          // each class.
};

// What follows the last dot of a file's name, in lower case.
std::string ExtensionOf(const std::string& path);

// The format by the extension of a path. Throws Error kBadOption.
PlaneFormat ParsePlaneFormat(const std::string& path);

// The shortest text that reads as the same number, whatever the locale.
std::string NumberText(double number);

// A convex face in the world frame: its three or four corners, counterclockwise
// against the normal.
using PlaneFace = std::vector<Eigen::Vector3d>;

// Cuts the polygons of a plane into faces, along its second axis.
std::vector<PlaneFace> MakeFaces(const ExportedPlane& plane);

// Whether a file holds a plane: JSON alone has those without faces.
bool IsWritten(const ExportedPlane& plane, PlaneFormat format);

// Writes atomically, the same planes as the same bytes; errors as AtomicFile.
void WritePlanes(const ContainedPath& path,
                 PlaneFormat format,
                 const ExportedPlanes& planes);

// Writers of the formats.
void PutPlanesJson(const ExportedPlanes& planes, std::ostream* out);
void PutPlanesObj(const ExportedPlanes& planes, std::ostream* out);
void PutPlanesDxf(const ExportedPlanes& planes, std::ostream* out);

}  // namespace tsar
