// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/dxf_writer.h"

#include "colmap_tsar/tools/plane_export/plane_mesh.h"

#include <array>
#include <cctype>

namespace tsar {
namespace {

// A layer with the name of its class and one of the standard color indices.
struct Layer {
  PlaneClass plane_class;
  int color;
};
constexpr std::array<Layer, 4> kLayers = {{{PlaneClass::kFloor, 3},
                                           {PlaneClass::kCeiling, 5},
                                           {PlaneClass::kWall, 1},
                                           {PlaneClass::kOther, 7}}};

}  // namespace

DxfWriter::DxfWriter(bool in_meters, std::ostream* out) : out_(out) {
  BeginSection("HEADER");
  Put(9, "$ACADVER");
  Put(1, "AC1009");
  constexpr int kUnitless = 0;
  constexpr int kMeters = 6;
  Put(9, "$INSUNITS");
  Put(70, in_meters ? kMeters : kUnitless);
  EndSection();
  PutLayers();
  BeginSection("ENTITIES");
}

void DxfWriter::Finish() {
  EndSection();
  Put(0, "EOF");
}

void DxfWriter::Put(int code, const std::string& value) {
  const std::string text = std::to_string(code);
  *out_ << std::string(3 - text.size(), ' ') << text << "\n" << value << "\n";
}

void DxfWriter::PutPoint(int code, const Eigen::Vector3d& point) {
  for (int i = 0; i < 3; ++i) {
    Put(code + 10 * i, NumberText(point[i]));
  }
}

std::string DxfWriter::LayerName(PlaneClass plane_class) {
  std::string name = ToString(plane_class);
  for (char& letter : name) {
    letter =
        static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  }
  return name;
}

void DxfWriter::BeginSection(const char* name) {
  Put(0, "SECTION");
  Put(2, name);
}

void DxfWriter::PutLayers() {
  BeginSection("TABLES");
  Put(0, "TABLE");
  Put(2, "LAYER");
  Put(70, static_cast<int>(kLayers.size()));
  for (const Layer& layer : kLayers) {
    Put(0, "LAYER");
    Put(2, LayerName(layer.plane_class));
    Put(70, 0);
    Put(62, layer.color);
    Put(6, "CONTINUOUS");
  }
  Put(0, "ENDTAB");
  EndSection();
}

}  // namespace tsar
