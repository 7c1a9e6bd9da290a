// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/exported_planes.h"

#include <ostream>
#include <string>

#include <Eigen/Core>

namespace tsar {

// Writes a DXF file (R12, ASCII), a sequence of pairs of lines: a group code
// and its value. The caller puts the entities.
class DxfWriter {
 public:
  // Begins the file, with the unit in $INSUNITS (meters or none) and a layer
  // for each class of planes.
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

}  // namespace tsar
