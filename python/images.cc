// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "python/bindings.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

using py::literals::operator""_a;

std::array<std::array<double, 4>, 3> PoseRows(const Camera& camera) {
  std::array<std::array<double, 4>, 3> rows{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      rows[row][column] = camera.rotation(row, column);
    }
    rows[row][3] = camera.translation[row];
  }
  return rows;
}

// {name: camera} of all images of the sparse model, in its order.
py::dict ReadImages(const std::filesystem::path& workspace_path) {
  SparseModel model;
  {
    const py::gil_scoped_release release;
    model = ReadTargetModel(workspace_path);
  }
  py::dict images;
  for (const SparseModel::ModelImage& image : model.images) {
    const Camera& camera = image.camera;
    images[ToText(image.name)] =
        py::dict("width"_a = camera.width,
                 "height"_a = camera.height,
                 "fx"_a = camera.fx,
                 "fy"_a = camera.fy,
                 "cx"_a = camera.cx,
                 "cy"_a = camera.cy,
                 "cam_from_world"_a = PoseRows(camera));
  }
  return images;
}

template <typename Read>
py::tuple ReadWithoutGil(const std::filesystem::path& path, const Read& read) {
  const auto map = [&] {
    const py::gil_scoped_release release;
    return read(path);
  }();
  return ToTuple(map);
}

struct MapKind {
  ContainedPath MapPaths::*path;
  std::function<py::tuple(const std::filesystem::path&)> read;
  // What makes such maps.
  const char* advice;
};

const std::map<std::string, MapKind>& MapKinds() {
  constexpr const char* kMatch = "make it with stereo() or patch_match_stereo";
  constexpr const char* kRefine = "refine the workspace first";
  const auto kind = [](auto path, auto read, const char* advice) {
    return MapKind{path,
                   [read](const std::filesystem::path& file) {
                     return ReadWithoutGil(file, read);
                   },
                   advice};
  };
  using Path = std::filesystem::path;
  static const std::map<std::string, MapKind> kinds = {
      {"depth",
       kind(
           &MapPaths::depth,
           [](const Path& path) { return ReadDepthMap(path); },
           kMatch)},
      {"normals",
       kind(
           &MapPaths::normal,
           [](const Path& path) { return ReadNormalMap(path); },
           kMatch)},
      {"confidence", kind(&MapPaths::confidence, &ReadGrayPng, kRefine)},
      {"sigma", kind(&MapPaths::sigma, &ReadSigmaMap, kRefine)},
      {"provenance", kind(&MapPaths::provenance, &ReadGrayPng, kRefine)},
      {"planes", kind(&MapPaths::planes, &ReadGray16Png, kRefine)},
  };
  return kinds;
}

py::tuple ReadMap(const std::filesystem::path& workspace_path,
                  const std::string& image_name,
                  const std::string& input_type,
                  const std::string& kind_name) {
  const MapKind& kind = MapKinds().at(kind_name);
  const std::filesystem::path path =
      GetMapPaths(workspace_path, image_name, ToMapType(input_type)).*kind.path;
  if (!Exists(path)) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "there is no such map",
                      kind.advice);
  }
  return kind.read(path);
}

bool HasDepthMap(const std::filesystem::path& workspace_path,
                 const std::string& image_name,
                 const std::string& input_type) {
  return Exists(
      GetMapPaths(workspace_path, image_name, ToMapType(input_type)).depth);
}

// Width and height.
py::tuple ReadDepthMapSize(const std::filesystem::path& workspace_path,
                           const std::string& image_name,
                           const std::string& input_type) {
  const MapSize size = ReadMapSize(
      GetMapPaths(workspace_path, image_name, ToMapType(input_type)).depth);
  return py::make_tuple(size.width, size.height);
}

}  // namespace

MapType ToMapType(const std::string& input_type) {
  for (const MapType type : kMapTypes) {
    if (input_type == ToString(type)) {
      return type;
    }
  }
  throw Error(
      ErrorCode::kBadOption,
      "input_type: '" + input_type + "' is not one of geometric, photometric");
}

void BindImages(py::module_* module) {
  // Raises for what is none.
  module->def("check_input_type",
              [](const std::string& input_type) { ToMapType(input_type); });
  module->def("read_images", &ReadImages);
  module->def("read_map", &ReadMap);
  module->def("has_depth_map", &HasDepthMap);
  module->def("read_depth_map_size", &ReadDepthMapSize);
  module->def("read_plane_map", [](const std::filesystem::path& path) {
    return ReadWithoutGil(path, &ReadGray16Png);
  });
}

}  // namespace tsar
