// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/companion_maps.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "python/bindings.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

using Numbers = std::array<double, 3>;

Numbers ToNumbers(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

std::array<Numbers, 3> ToRows(const Eigen::Matrix3d& matrix) {
  return {ToNumbers(matrix.row(0).transpose()),
          ToNumbers(matrix.row(1).transpose()),
          ToNumbers(matrix.row(2).transpose())};
}

std::vector<Numbers> ToWorld(const Ring& ring,
                             const PlaneCoordinates& coordinates) {
  std::vector<Numbers> points;
  for (const Eigen::Vector2d& point : ring) {
    points.push_back(ToNumbers(coordinates.ToWorld(point)));
  }
  return points;
}

py::list ToList(const std::vector<PlanePolygon>& polygons,
                const PlaneCoordinates& coordinates) {
  py::list list;
  for (const PlanePolygon& polygon : polygons) {
    py::list holes;
    for (const Ring& hole : polygon.holes) {
      holes.append(ToWorld(hole, coordinates));
    }
    py::dict dict;
    dict["outline"] = ToWorld(polygon.outline, coordinates);
    dict["holes"] = holes;
    list.append(dict);
  }
  return list;
}

py::dict ToDict(const ExportedPlane& plane) {
  py::dict images;
  for (const ExportedPlane::Sighting& sighting : plane.images) {
    images[ToText(sighting.image)] = sighting.num_pixels;
  }
  py::dict dict;
  dict["ids"] = plane.id;
  dict["classes"] = ToString(plane.plane_class);
  dict["normals"] = ToNumbers(plane.coordinates.normal);
  dict["offsets"] = plane.Offset();
  dict["centers"] = ToNumbers(plane.coordinates.origin);
  dict["axes"] = std::array<Numbers, 2>{ToNumbers(plane.coordinates.axis_s),
                                        ToNumbers(plane.coordinates.axis_t)};
  dict["covariances"] = ToRows(plane.covariance);
  dict["areas"] = plane.area;
  dict["resolutions"] = plane.cell;
  dict["shares_measured"] = plane.share_measured;
  dict["supports"] = plane.support;
  dict["num_pixels"] = plane.num_pixels;
  dict["components"] = plane.component;
  dict["frame_ids"] = plane.frame;
  dict["frame_axes"] = plane.axis;
  dict["meets"] = plane.meets;
  dict["images"] = images;
  dict["polygons"] = ToList(plane.polygons, plane.coordinates);
  return dict;
}

// A plane each, with what the attributes of the package's Planes hold of it.
py::dict ReadPlanes(const std::filesystem::path& workspace_path,
                    const std::optional<std::string>& input_type,
                    double min_area) {
  std::optional<MapType> type;
  if (input_type) {
    type = ToMapType(*input_type);
  }
  if (!(min_area >= 0.0 && std::isfinite(min_area))) {
    throw Error(ErrorCode::kBadOption,
                OptionName("min_area") + ": must be a number of at least 0");
  }
  std::ostream silent(nullptr);
  Progress progress(silent, /*is_terminal=*/false);
  ExportedPlanes planes;
  {
    const py::gil_scoped_release release;
    planes = ExportPlanes(OpenWorkspaceWithPlanes(workspace_path, type),
                          {.min_area = min_area},
                          progress,
                          [] {
                            // Ctrl-C is raised where it is seen.
                            const py::gil_scoped_acquire acquire;
                            if (PyErr_CheckSignals() != 0) {
                              throw py::error_already_set();
                            }
                            return false;
                          });
  }
  py::list list;
  for (const ExportedPlane& plane : planes.planes) {
    list.append(ToDict(plane));
  }
  std::vector<std::array<Numbers, 3>> frames;
  for (const Eigen::Matrix3d& frame : planes.frames) {
    frames.push_back(ToRows(frame.transpose()));
  }
  const bool has_vertical = planes.vertical.source != Vertical::Source::kNone;
  py::dict dict;
  dict["input_type"] = planes.type;
  dict["num_images"] = planes.num_images;
  dict["vertical"] = has_vertical ? py::cast(ToNumbers(planes.vertical.up))
                                  : py::object(py::none());
  dict["vertical_from"] = ToString(planes.vertical.source);
  dict["frames"] = frames;
  dict["planes"] = list;
  return dict;
}

// Width, height, and the pixels as 16-bit numbers: 1 + the plane's id.
py::tuple ReadPlaneMap(const std::filesystem::path& path) {
  Image<uint16_t> map;
  {
    const py::gil_scoped_release release;
    map = ReadGray16Png(path);
  }
  return py::make_tuple(
      map.Width(),
      map.Height(),
      py::bytes(reinterpret_cast<const char*>(map.Data()),
                sizeof(uint16_t) * static_cast<size_t>(map.Width()) *
                    static_cast<size_t>(map.Height())));
}

}  // namespace

void BindPlanes(py::module_* module) {
  module->def("read_planes", &ReadPlanes);
  module->def("read_plane_map", &ReadPlaneMap);
}

}  // namespace tsar
