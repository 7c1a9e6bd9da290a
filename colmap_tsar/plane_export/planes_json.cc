// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/write_planes.h"

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

// Row by row; what is infinite becomes null.
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

void PutPlanesJson(const ExportedPlanes& planes, std::ostream* out) {
  Json json;
  json["format"] = "tsar_planes";
  json["version"] = 1;
  json["maps"] = planes.type;
  json["num_images"] = planes.num_images;
  json["vertical"] = planes.vertical.source == Vertical::Source::kNone
                         ? Json()
                         : ToJson(planes.vertical.up);
  json["vertical_from"] = ToString(planes.vertical.source);
  json["frames"] = Json::array();
  for (const Eigen::Matrix3d& frame : planes.frames) {
    // An axis is a column.
    json["frames"].push_back(ToJson(Eigen::Matrix3d(frame.transpose())));
  }
  json["planes"] = Json::array();
  for (const ExportedPlane& plane : planes.planes) {
    json["planes"].push_back(ToJson(plane));
  }
  // Names of images need not be UTF-8.
  *out << json.dump(1, ' ', false, Json::error_handler_t::replace) << "\n";
}

}  // namespace tsar
