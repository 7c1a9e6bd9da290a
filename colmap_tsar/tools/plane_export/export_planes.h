// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

enum class PlaneClass { kFloor, kCeiling, kWall, kOther };

inline constexpr EnumNames<PlaneClass, 4> kPlaneClassNames = {
    {{PlaneClass::kFloor, "floor"},
     {PlaneClass::kCeiling, "ceiling"},
     {PlaneClass::kWall, "wall"},
     {PlaneClass::kOther, "other"}}};

inline std::string ToString(PlaneClass of_plane) {
  return EnumName(kPlaneClassNames, of_plane);
}

// The vertical direction and its source.
struct Vertical {
  enum class Source {
    kFrame,    // The axis of a Manhattan frame nearest to the cameras' up.
    kCameras,  // The mean up of the cameras, with no axis near it.
    kNone,     // Unknown: the cameras have no common up.
  };
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  // Unit vector or 0.
  Source source = Source::kNone;
};

inline std::string ToString(Vertical::Source source) {
  constexpr std::array kNames = {"manhattan_frame", "cameras", "none"};
  return kNames[static_cast<size_t>(source)];
}

// camera_ups: unit vectors, -y of each camera. frames: as in SceneModel.
Vertical FindVertical(const std::vector<Eigen::Vector3d>& camera_ups,
                      const std::vector<Eigen::Matrix3d>& frames);

// Classifies a plane. Floor and ceiling: the normal within 15 degrees of the
// vertical, and most of the cameras that see it above or below. Wall: the
// normal within 15 degrees of horizontal. Others, and all without a vertical:
// `other`. point: on the plane; cameras: centers of those that see it.
PlaneClass ClassifyPlane(const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& point,
                         const std::vector<Eigen::Vector3d>& cameras,
                         const Vertical& vertical);

// A plane of the scene in its exported form. Frame and units are those of the
// sparse model, unless TurnUp() or ScaleToMeters() changed them.
struct ExportedPlane {
  int id = 0;  // In planes.bin; plane maps hold 1 + id.
  PlaneClass plane_class = PlaneClass::kOther;
  // Coordinates whose normal points to the views of most of its pixels.
  PlaneCoordinates coordinates;
  // Covariance of the rotations about axis_s and axis_t (radians) and of the
  // shift along the normal. Infinite variances: unknown.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double support = 0.0;  // See ModelPlane.
  int component = 0;
  int frame = -1;
  int axis = -1;
  double area = 0.0;  // Area of the polygons.
  double cell = 0.0;  // Resolution of the polygons; 0: the plane is invisible.
  int64_t num_pixels = 0;
  double share_measured = 0.0;
  struct Sighting {
    std::string image;
    int64_t num_pixels = 0;
  };
  std::vector<Sighting> images;
  std::vector<int> meets;  // The planes with which it has a crease.
  // Polygons in its coordinates; the largest first.
  std::vector<PlanePolygon> polygons;

  // The offset in normal . X + Offset() = 0.
  double Offset() const { return -coordinates.normal.dot(coordinates.origin); }
};

struct ExportedPlanes {
  std::string type;  // Type of the maps: such as "geometric".
  int num_images = 0;
  Vertical vertical;
  std::vector<Eigen::Matrix3d> frames;  // See SceneModel.
  std::vector<ExportedPlane> planes;    // By id.
  // A rotation and scale: from the sparse model's coordinates to those here.
  Eigen::Matrix3d from_model = Eigen::Matrix3d::Identity();
  bool in_meters = false;  // False: in units of the sparse model.
};

// The written axis that points up; kModel: whichever does in the sparse model.
enum class UpAxis { kModel, kY, kZ };

inline constexpr EnumNames<UpAxis, 3> kUpAxisNames = {
    {{UpAxis::kModel, "model"}, {UpAxis::kY, "y"}, {UpAxis::kZ, "z"}}};

inline std::string ToString(UpAxis axis) {
  return EnumName(kUpAxisNames, axis);
}

// Turns planes about the origin until the vertical is this axis: for z the
// shortest way; for y then (x, y, z) becomes (x, z, -y), as programs convert
// files with y up, so that all files of a scene have the same heading. Throws
// Error kUnsupported where there is no vertical.
void TurnUp(UpAxis axis, ExportedPlanes* planes);

// Makes all lengths meters; a unit of the sparse model has meters_per_unit > 0.
void ScaleToMeters(double meters_per_unit, ExportedPlanes* planes);

// The planes of a refined workspace, from its stereo/tsar/planes.bin, with
// their visible parts in the refined maps of its type. Holds the maps of one
// image at a time and reads them twice. min_area: the least area of a plane, in
// square units of the sparse model.
//
// Throws Error: kNotFound (no scene planes, or no plane maps), kMismatch (maps,
// planes and model are not of one run), kInterrupted, and those of the readers.
ExportedPlanes ExportPlanes(const Workspace& workspace,
                            double min_area,
                            Progress& progress);

}  // namespace tsar
