// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"
#include "colmap_tsar/tools/plane_export/support_mask.h"
#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tsar {
namespace {

[[noreturn]] void ThrowNoPlanes(const Workspace& workspace) {
  const std::string type = ToString(workspace.Type());
  if (FindRefinedImages(workspace).empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      workspace.Root().string(),
                      "has no refined " + type + " maps",
                      "run tsar_refine on it first");
  }
  throw Error::File(
      ErrorCode::kNotFound,
      workspace.Root().string(),
      "its " + type +
          " maps were refined without keeping the planes of the scene",
      "run this version's tsar_refine on it, with the planes of the scene");
}

// Checks that plane maps refer to the planes of this model: those of another
// scene or run have the same indices.
void RequirePlanesOfMaps(const Workspace& workspace,
                         const std::vector<int>& images,
                         const std::filesystem::path& model_path) {
  const std::optional<uint64_t> planes_of_scene =
      ReadScenePlanesFingerprint(model_path);
  const std::string fingerprint =
      planes_of_scene ? std::to_string(*planes_of_scene) : "";
  for (const int image : images) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    const std::optional<ImageRecord> record = ReadRecordIfValid(paths.record);
    if (!record) {
      continue;
    }
    const auto planes = record->inputs.find(ImageRecord::kPlanes);
    if (planes != record->inputs.end() && planes->second != fingerprint) {
      throw Error::File(
          ErrorCode::kMismatch,
          model_path.string(),
          "does not hold the planes that " + paths.planes.string() + " names",
          "run tsar_refine again");
    }
  }
}

// What the views tell of each plane of the scene model.
struct PlaneObservations {
  std::vector<PlaneCoordinates> coordinates;
  std::vector<PlaneStatistics> statistics;
  std::vector<SupportGrid> grids;
  std::vector<Crease> creases;
};

// Reads the maps of the images twice.
PlaneObservations ObservePlanes(const Workspace& workspace,
                                const std::vector<int>& images,
                                const SceneModel& model,
                                Progress& progress,
                                const std::function<bool()>& is_stopped) {
  const auto visit_views = [&](const char* pass, const auto& function) {
    progress.Start(static_cast<int>(images.size()), pass);
    for (const int image : images) {
      if (is_stopped()) {
        progress.Finish();
        throw Error(ErrorCode::kInterrupted, "stopped; nothing was written");
      }
      function(ReadPlaneView(
          workspace, image, static_cast<int>(model.planes.size())));
      progress.Advance(true);
    }
    progress.Finish();
  };
  PlaneObservations seen;
  std::ranges::transform(
      model.planes, std::back_inserter(seen.coordinates), &CoordinatesOf);
  seen.statistics.resize(model.planes.size());
  CreaseFinder crease_finder(seen.coordinates);
  visit_views("Planes, pass 1 of 2:", [&](const PlaneView& view) {
    AddStatistics(view, seen.coordinates, &seen.statistics);
    crease_finder.Add(view);
  });
  seen.grids = MakeSupportGrids(seen.statistics);
  visit_views("Planes, pass 2 of 2:", [&](const PlaneView& view) {
    AddCoverage(view, seen.coordinates, &seen.grids);
  });
  seen.creases = crease_finder.Creases();
  return seen;
}

Vertical VerticalOf(const Workspace& workspace,
                    const std::vector<int>& images,
                    const SceneModel& model) {
  std::vector<Eigen::Vector3d> ups;
  for (const int image : images) {
    ups.push_back(
        -workspace.Model().images[image].camera.rotation.row(1).transpose());
  }
  return FindVertical(ups, model.frames);
}

// Flips a plane so that its normal points to the views that see it.
void Turn(ExportedPlane* plane) {
  plane->coordinates.normal *= -1.0;
  plane->coordinates.axis_t *= -1.0;
  const Eigen::DiagonalMatrix<double, 3> signs(1.0, -1.0, -1.0);
  plane->covariance = signs * plane->covariance * signs;
  const auto mirror = [](Ring* ring) {
    for (Eigen::Vector2d& point : *ring) {
      point.y() *= -1.0;
    }
    *ring = Ring(ring->rbegin(), ring->rend());
  };
  for (PlanePolygon& polygon : plane->polygons) {
    mirror(&polygon.outline);
    for (Ring& hole : polygon.holes) {
      mirror(&hole);
    }
  }
}

std::vector<Eigen::Vector3d> CentersOf(const PlaneStatistics& statistics,
                                       const SparseModel& sparse) {
  std::vector<Eigen::Vector3d> centers;
  for (const PlaneSighting& sighting : statistics.sightings) {
    centers.push_back(sparse.images[sighting.image].camera.Center());
  }
  return centers;
}

// Sets what needs neither polygons nor creases, in the coordinates of the
// model.
ExportedPlane Describe(const ModelPlane& model_plane,
                       const PlaneStatistics& statistics,
                       const PlaneCoordinates& coordinates,
                       const SparseModel& sparse,
                       const Vertical& vertical) {
  ExportedPlane plane;
  plane.coordinates = coordinates;
  plane.plane_class = ClassifyPlane(coordinates.normal,
                                    coordinates.origin,
                                    CentersOf(statistics, sparse),
                                    vertical);
  plane.covariance = model_plane.covariance;
  if (coordinates.axis_t.dot(model_plane.axis_t) < 0.0) {
    const Eigen::DiagonalMatrix<double, 3> signs(1.0, -1.0, 1.0);
    plane.covariance = signs * plane.covariance * signs;
  }
  plane.support = model_plane.support;
  plane.component = model_plane.component;
  plane.frame = model_plane.frame;
  plane.axis = model_plane.axis;
  plane.num_pixels = statistics.num_pixels;
  if (statistics.num_pixels > 0) {
    plane.share_measured = static_cast<double>(statistics.num_measured) /
                           static_cast<double>(statistics.num_pixels);
  }
  for (const PlaneSighting& sighting : statistics.sightings) {
    plane.images.push_back(
        {sparse.images[sighting.image].name, sighting.num_pixels});
  }
  return plane;
}

// Sets the creases, polygons and area of plane p, and frees its grid's memory.
void SetShape(int p, PlaneObservations* seen, ExportedPlane* plane) {
  for (const Crease& crease : seen->creases) {
    if (crease.first == p || crease.second == p) {
      plane->meets.push_back(crease.first == p ? crease.second : crease.first);
    }
  }
  SupportGrid& grid = seen->grids[p];
  plane->cell = grid.cell;
  if (plane->num_pixels > 0) {
    const std::vector<CreaseLine> lines =
        CreasesOf(p, seen->coordinates[p], seen->creases);
    plane->polygons = TracePolygons(grid, FindSupport(grid, lines), lines);
    grid.coverage = {};
  }
  for (const PlanePolygon& polygon : plane->polygons) {
    plane->area += Area(polygon);
  }
}

}  // namespace

bool HasPlanes(const Workspace& workspace) {
  return Exists(GetSceneModelPath(workspace.Root())) &&
         !FindPlaneViews(workspace).empty();
}

ExportedPlanes ExportPlanes(const Workspace& workspace,
                            const PlaneExportOptions& options,
                            Progress& progress,
                            const std::function<bool()>& is_stopped) {
  const std::filesystem::path model_path = GetSceneModelPath(workspace.Root());
  const std::vector<int> images = FindPlaneViews(workspace);
  if (!Exists(model_path) || images.empty()) {
    ThrowNoPlanes(workspace);
  }
  const SceneModel model =
      ReadSceneModel(model_path, SceneModelParts::kWithoutLabels);
  RequirePlanesOfMaps(workspace, images, model_path);
  PlaneObservations seen =
      ObservePlanes(workspace, images, model, progress, is_stopped);
  ExportedPlanes result;
  result.type = ToString(workspace.Type());
  result.num_images = static_cast<int>(images.size());
  result.vertical = VerticalOf(workspace, images, model);
  result.frames = model.frames;
  for (size_t p = 0; p < model.planes.size(); ++p) {
    ExportedPlane plane = Describe(model.planes[p],
                                   seen.statistics[p],
                                   seen.coordinates[p],
                                   workspace.Model(),
                                   result.vertical);
    plane.id = static_cast<int>(p);
    SetShape(plane.id, &seen, &plane);
    if (!seen.statistics[p].IsSeenFromNormalSide()) {
      Turn(&plane);
    }
    if (plane.area >= options.min_area) {
      result.planes.push_back(std::move(plane));
    }
  }
  return result;
}

}  // namespace tsar
