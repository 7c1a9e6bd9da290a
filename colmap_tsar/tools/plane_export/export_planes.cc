// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"
#include "colmap_tsar/tools/plane_export/support_mask.h"
#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kSine15 = 0.25881904510252074;
constexpr double kCosine15 = 0.9659258262890683;
constexpr double kCosine30 = 0.8660254037844387;
// The least length of a meaningful mean of unit vectors.
constexpr double kMinMeanUp = 0.2;

[[noreturn]] void ThrowNoPlanes(const Workspace& workspace) {
  RequireRefinedImages(workspace);
  throw Error::File(
      ErrorCode::kNotFound,
      workspace.Root().string(),
      "its " + ToString(workspace.Type()) +
          " maps were refined without keeping the planes of the scene",
      "run this version's tsar_refine on it, with the planes of the scene");
}

// Throws for plane maps of another scene or run, which have the same indices.
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
    if (record && !record->planes.empty() && record->planes != fingerprint) {
      throw Error::File(
          ErrorCode::kMismatch,
          model_path.string(),
          "does not hold the planes that " + paths.planes.string() + " names",
          "run tsar_refine again");
    }
  }
}

// What the views show of each plane of the scene model.
struct PlaneObservations {
  std::vector<PlaneCoordinates> coordinates;
  std::vector<PlaneStatistics> statistics;
  std::vector<SupportGrid> grids;
  std::vector<Crease> creases;
};

// Turns the normal of coordinates, and a box in them with it.
void TurnOver(PlaneCoordinates* coordinates, Eigen::AlignedBox2d* box) {
  coordinates->normal *= -1.0;
  coordinates->axis_t *= -1.0;
  const double top = -box->min().y();
  box->min().y() = -box->max().y();
  box->max().y() = top;
}

// Reads the maps of the images twice. Normals point to the views.
PlaneObservations ObservePlanes(const Workspace& workspace,
                                const std::vector<int>& images,
                                const SceneModel& model,
                                Progress& progress) {
  const auto visit_views = [&](const char* pass, const auto& function) {
    progress.Start(static_cast<int>(images.size()), pass);
    for (const int image : images) {
      progress.ThrowIfStopped("stopped; nothing was written");
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
  for (size_t p = 0; p < model.planes.size(); ++p) {
    if (!seen.statistics[p].IsSeenFromNormalSide()) {
      TurnOver(&seen.coordinates[p], &seen.statistics[p].box);
    }
  }
  seen.grids = MakeSupportGrids(seen.statistics);
  visit_views("Planes, pass 2 of 2:", [&](const PlaneView& view) {
    AddCoverage(view, seen.coordinates, &seen.grids);
  });
  seen.creases = crease_finder.Creases();
  return seen;
}

// Sets what needs no polygons or creases, in the model's coordinates.
ExportedPlane Describe(const ModelPlane& model_plane,
                       const PlaneStatistics& statistics,
                       const PlaneCoordinates& coordinates,
                       const SparseModel& sparse,
                       const Vertical& vertical) {
  ExportedPlane plane;
  plane.coordinates = coordinates;
  const Eigen::DiagonalMatrix<double, 3> signs(
      1.0,
      coordinates.axis_t.dot(model_plane.axis_t) < 0.0 ? -1.0 : 1.0,
      coordinates.normal.dot(model_plane.plane.normal) < 0.0 ? -1.0 : 1.0);
  plane.covariance = signs * model_plane.covariance * signs;
  plane.support = model_plane.support;
  plane.component = model_plane.component;
  plane.frame = model_plane.frame;
  plane.axis = model_plane.axis;
  plane.num_pixels = statistics.num_pixels;
  if (statistics.num_pixels > 0) {
    plane.share_measured = static_cast<double>(statistics.num_measured) /
                           static_cast<double>(statistics.num_pixels);
  }
  std::vector<Eigen::Vector3d> cameras;
  for (const PlaneSighting& sighting : statistics.sightings) {
    const SparseModel::ModelImage& image = sparse.images[sighting.image];
    plane.images.push_back({image.name, sighting.num_pixels});
    cameras.push_back(image.camera.Center());
  }
  plane.plane_class =
      ClassifyPlane(coordinates.normal, coordinates.origin, cameras, vertical);
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
    plane->area += polygon.area;
  }
}

}  // namespace

Vertical FindVertical(const std::vector<Eigen::Vector3d>& camera_ups,
                      const std::vector<Eigen::Matrix3d>& frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& up : camera_ups) {
    sum += up;
  }
  Vertical vertical;
  if (sum.norm() <= kMinMeanUp * static_cast<double>(camera_ups.size())) {
    return vertical;
  }
  vertical.up = sum.normalized();
  vertical.source = Vertical::Source::kCameras;
  const Eigen::Vector3d mean = vertical.up;
  double best = kCosine30;
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine = frame.col(axis).dot(mean);
      if (std::abs(cosine) > best) {
        best = std::abs(cosine);
        vertical.up = (cosine < 0.0 ? -1.0 : 1.0) * frame.col(axis);
        vertical.source = Vertical::Source::kFrame;
      }
    }
  }
  return vertical;
}

PlaneClass ClassifyPlane(const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& point,
                         const std::vector<Eigen::Vector3d>& cameras,
                         const Vertical& vertical) {
  if (vertical.source == Vertical::Source::kNone) {
    return PlaneClass::kOther;
  }
  const double cosine = normal.dot(vertical.up);
  if (std::abs(cosine) <= kSine15) {
    return PlaneClass::kWall;
  }
  if (std::abs(cosine) < kCosine15 || cameras.empty()) {
    return PlaneClass::kOther;
  }
  const Eigen::Vector3d upwards = (cosine < 0.0 ? -1.0 : 1.0) * normal;
  const auto num_above =
      std::ranges::count_if(cameras, [&](const Eigen::Vector3d& camera) {
        return upwards.dot(camera - point) > 0.0;
      });
  return 2 * static_cast<size_t>(num_above) >= cameras.size()
             ? PlaneClass::kFloor
             : PlaneClass::kCeiling;
}

void TurnUp(UpAxis axis, ExportedPlanes* planes) {
  if (axis == UpAxis::kModel) {
    return;
  }
  if (planes->vertical.source == Vertical::Source::kNone) {
    throw Error(ErrorCode::kUnsupported,
                OptionName("up") +
                    ": the cameras look all ways, so that nothing tells what "
                    "is up; leave the option out");
  }
  Eigen::Matrix3d rotation = Eigen::Quaterniond::FromTwoVectors(
                                 planes->vertical.up, Eigen::Vector3d::UnitZ())
                                 .toRotationMatrix();
  planes->vertical.up = Eigen::Vector3d::UnitZ();
  if (axis == UpAxis::kY) {
    Eigen::Matrix3d y_from_z;
    y_from_z << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    rotation = y_from_z * rotation;
    planes->vertical.up = Eigen::Vector3d::UnitY();
  }
  planes->from_model = rotation * planes->from_model;
  for (Eigen::Matrix3d& frame : planes->frames) {
    frame = rotation * frame;
  }
  for (ExportedPlane& plane : planes->planes) {
    PlaneCoordinates& at = plane.coordinates;
    for (Eigen::Vector3d* vector :
         {&at.origin, &at.axis_s, &at.axis_t, &at.normal}) {
      *vector = rotation * *vector;
    }
  }
}

void ScaleToMeters(double meters_per_unit, ExportedPlanes* planes) {
  planes->in_meters = true;
  planes->from_model *= meters_per_unit;
  for (ExportedPlane& plane : planes->planes) {
    plane.coordinates.origin *= meters_per_unit;
    // Its rotations are angles.
    plane.covariance.row(2) *= meters_per_unit;
    plane.covariance.col(2) *= meters_per_unit;
    plane.area *= meters_per_unit * meters_per_unit;
    plane.cell *= meters_per_unit;
    for (PlanePolygon& polygon : plane.polygons) {
      polygon.area *= meters_per_unit * meters_per_unit;
      std::vector<Ring*> rings = {&polygon.outline};
      for (Ring& hole : polygon.holes) {
        rings.push_back(&hole);
      }
      for (Ring* ring : rings) {
        for (Eigen::Vector2d& point : *ring) {
          point *= meters_per_unit;
        }
      }
    }
  }
}

ExportedPlanes ExportPlanes(const Workspace& workspace,
                            double min_area,
                            Progress& progress) {
  const std::filesystem::path model_path = GetSceneModelPath(workspace.Root());
  const std::vector<int> images = FindPlaneViews(workspace);
  if (!Exists(model_path) || images.empty()) {
    ThrowNoPlanes(workspace);
  }
  const SceneModel model =
      ReadSceneModel(model_path, SceneModelParts::kWithoutLabels);
  RequirePlanesOfMaps(workspace, images, model_path);
  WarnOfChangedResults(workspace, {"depth", "planes", "provenance"});
  PlaneObservations seen = ObservePlanes(workspace, images, model, progress);
  ExportedPlanes result;
  result.type = ToString(workspace.Type());
  result.num_images = static_cast<int>(images.size());
  std::vector<Eigen::Vector3d> ups;
  for (const int image : images) {
    ups.push_back(-workspace.CameraOf(image).rotation.row(1).transpose());
  }
  result.vertical = FindVertical(ups, model.frames);
  result.frames = model.frames;
  for (size_t p = 0; p < model.planes.size(); ++p) {
    ExportedPlane plane = Describe(model.planes[p],
                                   seen.statistics[p],
                                   seen.coordinates[p],
                                   workspace.Model(),
                                   result.vertical);
    plane.id = static_cast<int>(p);
    SetShape(plane.id, &seen, &plane);
    if (plane.area >= min_area) {
      result.planes.push_back(std::move(plane));
    }
  }
  return result;
}

}  // namespace tsar
