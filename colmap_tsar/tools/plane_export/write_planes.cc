// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/write_planes.h"

#include "colmap_tsar/base/parse_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/polygon/polygon.hpp>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

// Standard color indices of the layers, by PlaneClass.
constexpr std::array kLayerColors = {3, 5, 1, 7};

void PutFaces(const ExportedPlane& plane,
              const std::string& layer,
              DxfWriter* dxf) {
  for (const PlaneFace& face : MakeFaces(plane)) {
    dxf->Put(0, "3DFACE");
    dxf->Put(8, layer);
    for (size_t i = 0; i < 4; ++i) {
      // Three corners repeat the last one.
      dxf->PutPoint(static_cast<int>(10 + i),
                    face[std::min(i, face.size() - 1)]);
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

namespace bp = boost::polygon;

// The largest integer coordinate of a plane's points.
constexpr double kMaxCoordinate = 1 << 28;

bp::polygon_data<int> ToIntegers(const Ring& ring, double scale) {
  std::vector<bp::point_data<int>> points;
  for (const Eigen::Vector2d& point : ring) {
    points.emplace_back(static_cast<int>(std::lround(scale * point.x())),
                        static_cast<int>(std::lround(scale * point.y())));
  }
  bp::polygon_data<int> polygon;
  bp::set_points(polygon, points.begin(), points.end());
  return polygon;
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
  return boost::to_upper_copy(ToString(plane_class));
}

void DxfWriter::BeginSection(const char* name) {
  Put(0, "SECTION");
  Put(2, name);
}

void DxfWriter::PutLayers() {
  BeginSection("TABLES");
  Put(0, "TABLE");
  Put(2, "LAYER");
  Put(70, static_cast<int>(kLayerColors.size()));
  for (size_t i = 0; i < kLayerColors.size(); ++i) {
    Put(0, "LAYER");
    Put(2, LayerName(static_cast<PlaneClass>(i)));
    Put(70, 0);
    Put(62, kLayerColors[i]);
    Put(6, "CONTINUOUS");
  }
  Put(0, "ENDTAB");
  EndSection();
}

void PutPlanesDxf(const ExportedPlanes& planes, std::ostream* out) {
  DxfWriter dxf(planes.in_meters, out);
  for (const ExportedPlane& plane : planes.planes) {
    const std::string layer = DxfWriter::LayerName(plane.plane_class);
    PutFaces(plane, layer, &dxf);
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
  const auto put = [&](const char* kind, const Eigen::Vector3d& vector) {
    *out << kind << " " << NumberText(vector.x()) << " "
         << NumberText(vector.y()) << " " << NumberText(vector.z()) << "\n";
  };
  // Indices count from 1 through the file.
  size_t num_points = 0;
  size_t num_normals = 0;
  for (const ExportedPlane& plane : planes.planes) {
    if (plane.polygons.empty()) {
      continue;
    }
    *out << "g plane_" << plane.id << "_" << ToString(plane.plane_class)
         << "\n";
    put("vn", plane.coordinates.normal);
    ++num_normals;
    for (const PlaneFace& face : MakeFaces(plane)) {
      for (const Eigen::Vector3d& corner : face) {
        put("v", corner);
      }
      *out << "f";
      for (size_t i = 0; i < face.size(); ++i) {
        *out << " " << ++num_points << "//" << num_normals;
      }
      *out << "\n";
    }
  }
}

std::vector<PlaneFace> MakeFaces(const ExportedPlane& plane) {
  double extent = 0.0;
  for (const PlanePolygon& polygon : plane.polygons) {
    for (const Eigen::Vector2d& point : polygon.outline) {
      extent = std::max(extent, point.cwiseAbs().maxCoeff());
    }
  }
  const double scale = kMaxCoordinate / extent;
  bp::polygon_set_data<int> set;
  for (const PlanePolygon& polygon : plane.polygons) {
    set.insert(ToIntegers(polygon.outline, scale));
    for (const Ring& hole : polygon.holes) {
      set.insert(ToIntegers(hole, scale), /*is_hole=*/true);
    }
  }
  std::vector<bp::polygon_data<int>> trapezoids;
  set.get_trapezoids(trapezoids);
  std::vector<PlaneFace> faces;
  for (const bp::polygon_data<int>& trapezoid : trapezoids) {
    // The last point is the first again; those of neighbors on its two parallel
    // sides are no corners.
    const std::vector<bp::point_data<int>> points(trapezoid.begin(),
                                                  trapezoid.end() - 1);
    PlaneFace face;
    for (size_t i = 0; i < points.size(); ++i) {
      const int x = points[i].x();
      if (x != points[(i + 1) % points.size()].x() ||
          x != points[(i + points.size() - 1) % points.size()].x()) {
        face.push_back(plane.coordinates.ToWorld(
            Eigen::Vector2d(x, points[i].y()) / scale));
      }
    }
    if (bp::winding(trapezoid) == bp::CLOCKWISE) {
      std::ranges::reverse(face);
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

bool IsWritten(const ExportedPlane& plane, PlanesWriter writer) {
  return writer == &PutPlanesJson || !plane.polygons.empty();
}

PlanesWriter PlanesWriterFor(const std::filesystem::path& path) {
  return WriterFor<PlanesWriter>(path,
                                 "output_path",
                                 {{".json", &PutPlanesJson},
                                  {".obj", &PutPlanesObj},
                                  {".dxf", &PutPlanesDxf}});
}

}  // namespace tsar
