// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <array>
#include <cmath>
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

using py::literals::operator""_a;

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
    list.append(py::dict("outline"_a = ToWorld(polygon.outline, coordinates),
                         "holes"_a = holes));
  }
  return list;
}

py::dict ToDict(const ExportedPlane& plane) {
  py::dict images;
  for (const ExportedPlane::Sighting& sighting : plane.images) {
    images[ToText(sighting.image)] = sighting.num_pixels;
  }
  return py::dict(
      "ids"_a = plane.id,
      "classes"_a = ToString(plane.plane_class),
      "normals"_a = ToNumbers(plane.coordinates.normal),
      "offsets"_a = plane.Offset(),
      "centers"_a = ToNumbers(plane.coordinates.origin),
      "axes"_a = std::array<Numbers, 2>{ToNumbers(plane.coordinates.axis_s),
                                        ToNumbers(plane.coordinates.axis_t)},
      "covariances"_a = ToRows(plane.covariance),
      "areas"_a = plane.area,
      "resolutions"_a = plane.cell,
      "shares_measured"_a = plane.share_measured,
      "supports"_a = plane.support,
      "num_pixels"_a = plane.num_pixels,
      "components"_a = plane.component,
      "frame_ids"_a = plane.frame,
      "frame_axes"_a = plane.axis,
      "meets"_a = plane.meets,
      "images"_a = images,
      "polygons"_a = ToList(plane.polygons, plane.coordinates));
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
  progress.SetStop([] {
    // Ctrl-C is raised where it is seen.
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) {
      throw py::error_already_set();
    }
    return false;
  });
  ExportedPlanes planes;
  {
    const py::gil_scoped_release release;
    planes = ExportPlanes(
        OpenWorkspaceWithMaps(workspace_path, type), min_area, progress);
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
  return py::dict("input_type"_a = planes.type,
                  "num_images"_a = planes.num_images,
                  "vertical"_a = has_vertical
                                     ? py::cast(ToNumbers(planes.vertical.up))
                                     : py::object(py::none()),
                  "vertical_from"_a = ToString(planes.vertical.source),
                  "frames"_a = frames,
                  "planes"_a = list);
}

}  // namespace

void BindPlanes(py::module_* module) {
  module->def("read_planes", &ReadPlanes);
}

}  // namespace tsar
