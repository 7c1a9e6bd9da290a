// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/write_planes.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/tools/plane_export/plane_mesh.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <filesystem>

#include <nlohmann/json.hpp>

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

void PutTriangles(const PlaneMesh& mesh,
                  const std::string& layer,
                  DxfWriter* dxf) {
  for (const auto& [a, b, c] : mesh.triangles) {
    dxf->Put(0, "3DFACE");
    dxf->Put(8, layer);
    int code = 10;
    // A 3DFACE triangle repeats its last corner.
    for (const int corner : {a, b, c, c}) {
      dxf->PutPoint(code++, mesh.points[corner]);
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

using Json = nlohmann::ordered_json;

Json ToJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

// A matrix row by row; infinite values become null.
Json ToJson(const Eigen::Matrix3d& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) {
    rows.push_back(ToJson(Eigen::Vector3d(matrix.row(row).transpose())));
  }
  return rows;
}

Json ToJson(const Ring& ring, const PlaneCoordinates& coordinates) {
  Json points = Json::array();
  for (const Eigen::Vector2d& point : ring) {
    points.push_back(ToJson(coordinates.ToWorld(point)));
  }
  return points;
}

Json ToJson(const PlanePolygon& polygon, const PlaneCoordinates& coordinates) {
  Json json;
  json["outline"] = ToJson(polygon.outline, coordinates);
  json["holes"] = Json::array();
  for (const Ring& hole : polygon.holes) {
    json["holes"].push_back(ToJson(hole, coordinates));
  }
  return json;
}

Json ToJson(const ExportedPlane& plane) {
  Json json;
  json["id"] = plane.id;
  json["class"] = ToString(plane.plane_class);
  json["normal"] = ToJson(plane.coordinates.normal);
  json["offset"] = plane.Offset();
  json["center"] = ToJson(plane.coordinates.origin);
  json["axis_s"] = ToJson(plane.coordinates.axis_s);
  json["axis_t"] = ToJson(plane.coordinates.axis_t);
  json["covariance"] = ToJson(plane.covariance);
  json["area"] = plane.area;
  json["resolution"] = plane.cell;
  json["share_measured"] = plane.share_measured;
  json["support"] = plane.support;
  json["num_pixels"] = plane.num_pixels;
  json["component"] = plane.component;
  json["frame"] = plane.frame >= 0 ? Json(plane.frame) : Json();
  json["axis"] = plane.axis >= 0 ? Json(plane.axis) : Json();
  json["meets"] = plane.meets;
  json["images"] = Json::array();
  for (const ExportedPlane::Sighting& sighting : plane.images) {
    json["images"].push_back(
        {{"name", sighting.image}, {"num_pixels", sighting.num_pixels}});
  }
  json["polygons"] = Json::array();
  for (const PlanePolygon& polygon : plane.polygons) {
    json["polygons"].push_back(ToJson(polygon, plane.coordinates));
  }
  return json;
}

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

void PutPlanesDxf(const ExportedPlanes& planes, std::ostream* out) {
  DxfWriter dxf(planes.in_meters, out);
  for (const ExportedPlane& plane : planes.planes) {
    const std::string layer = DxfWriter::LayerName(plane.plane_class);
    PutTriangles(MakePlaneMesh(plane), layer, &dxf);
    for (const PlanePolygon& polygon : plane.polygons) {
      PutOutline(polygon.outline, plane.coordinates, layer, &dxf);
      for (const Ring& hole : polygon.holes) {
        PutOutline(hole, plane.coordinates, layer, &dxf);
      }
    }
  }
  dxf.Finish();
}

void PutPlanesJson(const ExportedPlanes& planes, std::ostream* out) {
  Json json;
  json["format"] = "tsar_planes";
  json["version"] = 1;
  json["maps"] = planes.type;
  json["num_images"] = planes.num_images;
  json["unit"] = planes.in_meters ? "meter" : "model";
  json["from_model"] = ToJson(planes.from_model);
  json["vertical"] = planes.vertical.source == Vertical::Source::kNone
                         ? Json()
                         : ToJson(planes.vertical.up);
  json["vertical_from"] = ToString(planes.vertical.source);
  json["frames"] = Json::array();
  for (const Eigen::Matrix3d& frame : planes.frames) {
    // The axes are the columns.
    json["frames"].push_back(ToJson(Eigen::Matrix3d(frame.transpose())));
  }
  json["planes"] = Json::array();
  for (const ExportedPlane& plane : planes.planes) {
    json["planes"].push_back(ToJson(plane));
  }
  // Names of images need not be UTF-8.
  *out << json.dump(1, ' ', false, Json::error_handler_t::replace) << "\n";
}

void PutPlanesObj(const ExportedPlanes& planes, std::ostream* out) {
  *out << "# planes of the scene, by tsar_planes\n";
  size_t num_points = 0;
  size_t num_normals = 0;
  for (const ExportedPlane& plane : planes.planes) {
    const PlaneMesh mesh = MakePlaneMesh(plane);
    if (mesh.triangles.empty()) {
      continue;
    }
    *out << "g plane_" << plane.id << "_" << ToString(plane.plane_class)
         << "\n";
    for (const Eigen::Vector3d& point : mesh.points) {
      *out << "v " << PointText(point) << "\n";
    }
    *out << "vn " << PointText(plane.coordinates.normal) << "\n";
    ++num_normals;
    for (const auto& triangle : mesh.triangles) {
      *out << "f";
      for (const int corner : triangle) {
        // Indices count from 1 through the file.
        *out << " " << num_points + static_cast<size_t>(corner) + 1 << "//"
             << num_normals;
      }
      *out << "\n";
    }
    num_points += mesh.points.size();
  }
}

void PutPlanesPly(const ExportedPlanes& planes, std::ostream* out) {
  std::vector<PlaneMesh> meshes;
  size_t num_points = 0;
  size_t num_triangles = 0;
  for (const ExportedPlane& plane : planes.planes) {
    meshes.push_back(MakePlaneMesh(plane));
    num_points += meshes.back().points.size();
    num_triangles += meshes.back().triangles.size();
  }
  // Coordinates are doubles, for georeferenced models.
  *out << "ply\nformat ascii 1.0\n"
       << "comment planes of the scene, by tsar_planes\n"
       << "element vertex " << num_points << "\n"
       << "property double x\nproperty double y\nproperty double z\n"
       << "property uchar red\nproperty uchar green\nproperty uchar blue\n"
       << "element face " << num_triangles << "\n"
       << "property list uchar int vertex_indices\nproperty int plane\n"
       << "end_header\n";
  for (size_t i = 0; i < meshes.size(); ++i) {
    const Rgb color = LabelColor(planes.planes[i].id);
    for (const Eigen::Vector3d& point : meshes[i].points) {
      *out << PointText(point) << " " << int{color.r} << " " << int{color.g}
           << " " << int{color.b} << "\n";
    }
  }
  size_t first = 0;
  for (size_t i = 0; i < meshes.size(); ++i) {
    for (const auto& triangle : meshes[i].triangles) {
      *out << "3";
      for (const int corner : triangle) {
        *out << " " << first + static_cast<size_t>(corner);
      }
      *out << " " << planes.planes[i].id << "\n";
    }
    first += meshes[i].points.size();
  }
}

const std::vector<std::string>& PlaneFormatNames() {
  static const std::vector<std::string> names = {
      "json", "ply", "obj", "dxf", "glb"};
  return names;
}

std::string ExtensionOf(const std::string& path) {
  return FoldedCase(std::filesystem::path(path).extension().string())
      .erase(0, 1);
}

PlaneFormat ParsePlaneFormat(const std::string& name, const std::string& path) {
  const std::string wanted = name.empty() ? ExtensionOf(path) : name;

  const std::vector<std::string>& names = PlaneFormatNames();
  const auto found = std::ranges::find(names, wanted);
  if (found == names.end()) {
    throw Error(ErrorCode::kBadOption,
                name.empty()
                    ? OptionName("output_path") + ": the name " + path +
                          " does not tell the format; let it end in .json, "
                          ".ply, .obj, .dxf or .glb, or give " +
                          OptionName("format")
                    : OptionName("format") + ": '" + name +
                          "' is not known; give json, ply, obj, dxf or glb");
  }
  return static_cast<PlaneFormat>(found - names.begin());
}

bool IsWritten(const ExportedPlane& plane, PlaneFormat format) {
  return format == PlaneFormat::kJson || !plane.polygons.empty();
}

void WritePlanes(const ContainedPath& path,
                 PlaneFormat format,
                 const ExportedPlanes& planes) {
  // In the order of PlaneFormat.
  constexpr std::array kWriters = {&PutPlanesJson,
                                   &PutPlanesPly,
                                   &PutPlanesObj,
                                   &PutPlanesDxf,
                                   &PutPlanesGlb};
  AtomicFile file(path);
  kWriters[static_cast<size_t>(format)](planes, &file.Stream());
  file.Commit();
}

}  // namespace tsar
