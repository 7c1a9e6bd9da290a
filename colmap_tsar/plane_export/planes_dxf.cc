// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_mesh.h"
#include "colmap_tsar/plane_export/write_planes.h"

#include <array>
#include <cctype>

namespace tsar {
namespace {

// A layer has the name of its class, and one of the colours that all programs
// number alike.
struct Layer {
  PlaneClass plane_class;
  int color;
};
constexpr std::array<Layer, 4> kLayers = {{{PlaneClass::kFloor, 3},
                                           {PlaneClass::kCeiling, 5},
                                           {PlaneClass::kWall, 1},
                                           {PlaneClass::kOther, 7}}};

std::string LayerName(PlaneClass plane_class) {
  std::string name = ToString(plane_class);
  for (char& letter : name) {
    letter =
        static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  }
  return name;
}

// A DXF file is a sequence of pairs: a line with the code that says what the
// next line means, and that line.
class DxfWriter {
 public:
  explicit DxfWriter(std::ostream* out) : out_(out) {}

  void Put(int code, const std::string& value) {
    const std::string text = std::to_string(code);
    *out_ << std::string(3 - text.size(), ' ') << text << "\n" << value << "\n";
  }
  void Put(int code, int value) { Put(code, std::to_string(value)); }
  // Codes code, code + 10 and code + 20.
  void PutPoint(int code, const Eigen::Vector3d& point) {
    for (int i = 0; i < 3; ++i) {
      Put(code + 10 * i, NumberText(point[i]));
    }
  }

  void BeginSection(const char* name) {
    Put(0, "SECTION");
    Put(2, name);
  }
  void EndSection() { Put(0, "ENDSEC"); }

 private:
  std::ostream* out_;
};

void PutLayers(DxfWriter* dxf) {
  dxf->BeginSection("TABLES");
  dxf->Put(0, "TABLE");
  dxf->Put(2, "LAYER");
  dxf->Put(70, static_cast<int>(kLayers.size()));
  for (const Layer& layer : kLayers) {
    dxf->Put(0, "LAYER");
    dxf->Put(2, LayerName(layer.plane_class));
    dxf->Put(70, 0);
    dxf->Put(62, layer.color);
    dxf->Put(6, "CONTINUOUS");
  }
  dxf->Put(0, "ENDTAB");
  dxf->EndSection();
}

void PutTriangles(const PlaneMesh& mesh,
                  const std::string& layer,
                  DxfWriter* dxf) {
  for (const auto& [a, b, c] : mesh.triangles) {
    dxf->Put(0, "3DFACE");
    dxf->Put(8, layer);
    int code = 10;
    // A triangle has its last corner twice.
    for (const int corner : {a, b, c, c}) {
      dxf->PutPoint(code++, mesh.points[static_cast<size_t>(corner)]);
    }
  }
}

void PutOutline(const Ring& ring,
                const PlaneCoordinates& coordinates,
                const std::string& layer,
                DxfWriter* dxf) {
  constexpr int kClosed = 1;
  constexpr int k3dPolyline = 8;
  constexpr int k3dVertex = 32;
  dxf->Put(0, "POLYLINE");
  dxf->Put(8, layer);
  dxf->Put(66, 1);  // Vertices follow.
  dxf->PutPoint(10, Eigen::Vector3d::Zero());
  dxf->Put(70, kClosed | k3dPolyline);
  for (const Eigen::Vector2d& point : ring) {
    dxf->Put(0, "VERTEX");
    dxf->Put(8, layer);
    dxf->PutPoint(10, coordinates.ToWorld(point));
    dxf->Put(70, k3dVertex);
  }
  dxf->Put(0, "SEQEND");
  dxf->Put(8, layer);
}

}  // namespace

void PutPlanesDxf(const ExportedPlanes& planes, std::ostream* out) {
  DxfWriter dxf(out);
  dxf.BeginSection("HEADER");
  dxf.Put(9, "$ACADVER");
  dxf.Put(1, "AC1009");
  dxf.EndSection();
  PutLayers(&dxf);
  dxf.BeginSection("ENTITIES");
  for (const ExportedPlane& plane : planes.planes) {
    const std::string layer = LayerName(plane.plane_class);
    PutTriangles(MakePlaneMesh(plane), layer, &dxf);
    for (const PlanePolygon& polygon : plane.polygons) {
      PutOutline(polygon.outline, plane.coordinates, layer, &dxf);
      for (const Ring& hole : polygon.holes) {
        PutOutline(hole, plane.coordinates, layer, &dxf);
      }
    }
  }
  dxf.EndSection();
  dxf.Put(0, "EOF");
}

}  // namespace tsar
