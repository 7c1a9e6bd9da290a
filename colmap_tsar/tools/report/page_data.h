// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"
#include "colmap_tsar/tools/evaluation/depth_evaluation.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/report/image_page.h"
#include "colmap_tsar/tools/report/point_sample.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The scene planes on the page, each in the LabelColor() of its id.
struct PlanePage {
  struct Plane {
    int id = 0;
    PlaneClass plane_class = PlaneClass::kOther;
    double area = 0.0;  // In square units of the sparse model.
    // The degrees to horizontal or vertical, the nearer one, if known.
    std::optional<double> tilt;
    int64_t num_images = 0;
    double share_measured = 0.0;
    // Standard deviation of the offset, in units of the model, if known.
    std::optional<double> sigma;
    // Its part of the mesh.
    int64_t first_vertex = 0;
    int64_t num_vertices = 0;
  };
  // Planes by descending area, then by id.
  std::vector<Plane> planes;
  // Three vertices for each triangle, counterclockwise if the plane's normal
  // points to the viewer; relative to the origin.
  PointSample mesh;
};

PlanePage MakePlanePage(const ExportedPlanes& planes,
                        const Eigen::Vector3d& origin);

// An evaluation before and after refinement.
template <typename Evaluation>
struct Gain {
  Evaluation before;
  Evaluation after;
};

// The gains of refinement by ground truth.
struct Gains {
  std::optional<Gain<DepthEvaluation>> depth;
  std::optional<Gain<CloudEvaluation>> clouds;
};

// An image that kept its maps.
struct KeptImage {
  std::string name;
  std::string reason;
};

// The content of the 3D view.
struct PointView {
  bool from_clouds = false;       // Otherwise, sampled from the maps.
  bool before_from_maps = false;  // Maps before, a cloud after.
  // Whether the cloud before, after, was fused for the page, and how.
  bool fused[2] = {false, false};
  std::string fusion;
  int64_t num_shown[2] = {0, 0};  // Before, after.
  int64_t num_all[2] = {0, 0};
  // The initial viewpoint, relative to the points' origin. Without a target,
  // the view looks at the middle of the points.
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> target;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
};

// The content of the page.
struct PageData {
  std::string version;
  std::string workspace;
  std::string type;
  std::vector<ImagePage> images;  // Without their points.
  std::vector<KeptImage> kept;
  PointView points;
  std::optional<PlanePage> planes;  // Without their mesh.
  Gains gains;
};

// The script window.tsarReport = {...}, one statement for any names.
std::string PageDataScript(const PageData& data);

// The numbers of each refined image as a table (CSV, RFC 4180): its name, the
// pixels of its maps, those with depth before and after, those of each origin,
// seconds.
std::string ImageTable(const PageData& data);

}  // namespace tsar
