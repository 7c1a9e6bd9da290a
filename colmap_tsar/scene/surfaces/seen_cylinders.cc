// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/seen_cylinders.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/cylinder.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene/surfaces/axis_camera.h"
#include "colmap_tsar/scene/surfaces/common_heights.h"
#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>

namespace tsar {

namespace {

// The largest distance of an edge from an expected outline, in pixels.
constexpr double kMaxDifference = 1.5;
// The least number of contiguous rows with outlines, and the largest gap in
// them.
constexpr size_t kMinRows = 8;
constexpr size_t kMaxGap = 8;

bool HasEdge(const std::vector<AcrossEdge>& edges, double column) {
  return std::ranges::any_of(edges, [&](const AcrossEdge& edge) {
    return std::abs(edge.column - column) <= kMaxDifference;
  });
}

// The rows in which the view shows all outlines that lie in its image.
std::vector<uint8_t> RowsWithOutlines(
    const std::vector<std::vector<AcrossEdge>>& edges,
    const AxisCamera& camera,
    const CircleOutline& outline) {
  std::vector<uint8_t> rows(edges.size(), 0);
  for (size_t row = 0; row < edges.size(); ++row) {
    bool is_any = false;
    bool is_all = true;
    for (const double column : {outline.left, outline.right}) {
      if (IsInRaster(camera, column, row)) {
        is_any = true;
        is_all = is_all && HasEdge(edges[row], column);
      }
    }
    rows[row] = is_any && is_all ? 1 : 0;
  }
  return rows;
}

void CloseGapsAndDropShort(std::vector<uint8_t>* rows) {
  const size_t count = rows->size();
  const auto set = [&](size_t begin, size_t end, uint8_t value) {
    std::fill(rows->begin() + begin, rows->begin() + end, value);
  };
  const auto is_set = [&](size_t row) { return (*rows)[row] != 0; };
  for (const auto& [begin, end] : RunsOf(count, std::not_fn(is_set))) {
    if (begin > 0 && end < count && end - begin <= kMaxGap) {
      set(begin, end, 1);
    }
  }
  for (const auto& [begin, end] : RunsOf(count, is_set)) {
    if (end - begin < kMinRows) {
      set(begin, end, 0);
    }
  }
}

// Marks the visible bins; returns whether there are any.
bool MarkSeen(const std::vector<uint8_t>& rows,
              const AxisCamera& camera,
              const CircleOutline& outline,
              const ModelCylinder& model,
              SeenCylinder* seen) {
  const double distance = outline.MeanDistance();
  const double bins_per_height =
      SeenCylinder::kNumBins / (model.max_height - model.min_height);
  bool is_any = false;
  for (size_t row = 0; row < rows.size(); ++row) {
    if (rows[row] == 0) {
      continue;
    }
    const auto bin_at = [&](double position) {
      return std::clamp((camera.Height(position, distance) - model.min_height) *
                            bins_per_height,
                        0.0,
                        double{SeenCylinder::kNumBins});
    };
    const int begin = static_cast<int>(bin_at(row - 0.5));
    const int end = static_cast<int>(std::ceil(bin_at(row + 0.5)));
    for (int bin = begin; bin < end; ++bin) {
      seen->is_seen[bin] = 1;
      is_any = true;
    }
  }
  return is_any;
}

// The distance from the cylinder beyond which a depth is of another surface, in
// relative depths of one pixel of disparity.
constexpr float kMinGap = 3.f;

}  // namespace

SeenCylinder ToCameraCylinder(const ModelCylinder& cylinder,
                              const Camera& camera) {
  SeenCylinder seen;
  const Eigen::Vector3d begin =
      cylinder.point + cylinder.min_height * cylinder.frame.along;
  seen.cylinder.point = ToVec3f(camera.rotation * begin + camera.translation);
  seen.cylinder.axis = ToVec3f(camera.rotation * cylinder.frame.along);
  seen.cylinder.radius = static_cast<float>(cylinder.radius);
  seen.length = static_cast<float>(cylinder.max_height - cylinder.min_height);
  seen.across = ToVec3f(camera.rotation * cylinder.frame.across);
  seen.third = ToVec3f(camera.rotation * cylinder.frame.Third());
  for (int i = 0; i < 3; ++i) {
    seen.variances[i] = static_cast<float>(cylinder.covariance(i, i));
  }
  seen.covariances[0] = static_cast<float>(cylinder.covariance(0, 1));
  seen.covariances[1] = static_cast<float>(cylinder.covariance(0, 2));
  seen.covariances[2] = static_cast<float>(cylinder.covariance(1, 2));
  return seen;
}

std::vector<SeenCylinder> FindSeenCylinders(
    const ObservedView& view, const std::vector<ModelCylinder>& cylinders) {
  std::vector<SeenCylinder> result;
  std::optional<AxisCamera> axis_camera;
  std::vector<std::vector<AcrossEdge>> edges;
  const ModelCylinder* last = nullptr;
  for (const ModelCylinder& cylinder : cylinders) {
    // Cylinders are grouped by axis.
    if (last == nullptr || cylinder.frame != last->frame) {
      axis_camera = MakeAxisCamera(view.camera, cylinder.frame);
      if (axis_camera) {
        edges = FindEdgesAcross(view.evidence->color, *axis_camera);
      }
    }
    last = &cylinder;
    if (!axis_camera) {
      continue;
    }
    const std::optional<CircleOutline> outline = OutlineOf(
        {cylinder.frame.Across(cylinder.point), cylinder.radius}, *axis_camera);
    if (!outline) {
      continue;
    }
    std::vector<uint8_t> rows = RowsWithOutlines(edges, *axis_camera, *outline);
    CloseGapsAndDropShort(&rows);
    SeenCylinder seen = ToCameraCylinder(cylinder, view.camera);
    if (MarkSeen(rows, *axis_camera, *outline, cylinder, &seen)) {
      result.push_back(seen);
    }
  }
  return result;
}

std::vector<CylinderEvidence> TestCylinders(
    const ObservedView& view,
    const std::vector<ModelPlane>& planes,
    const ViewLabels& labels,
    const std::vector<ModelCylinder>& cylinders) {
  const ViewEvidence& evidence = *view.evidence;
  const Intrinsics intrinsics = view.camera.GetIntrinsics();
  std::vector<CylinderEvidence> result(cylinders.size());
  std::vector<Plane> camera_planes;
  for (const ModelPlane& plane : planes) {
    camera_planes.push_back(ToCameraPlane(plane.plane, view.camera));
  }
  for (size_t k = 0; k < cylinders.size(); ++k) {
    const SeenCylinder seen = ToCameraCylinder(cylinders[k], view.camera);
    for (int y = 0; y < evidence.height; ++y) {
      for (int x = 0; x < evidence.width; ++x) {
        const Vec3f ray = intrinsics.Ray(x, y);
        Cylinder::Intersection intersection;
        if (!seen.cylinder.Intersect(ray, &intersection) ||
            intersection.height < 0.f || intersection.height > seen.length ||
            !seen.FacesCamera(intersection.normal, ray)) {
          continue;
        }
        const float gap =
            kMinGap * intersection.depth *
            evidence.resolution.RelativeDepthError(intersection.depth);
        const float measured = evidence.confident_depth(x, y);
        if (measured > 0.f && measured < intersection.depth - gap) {
          continue;
        }
        ++result[k].area;
        result[k].through += measured > intersection.depth + gap ? 1 : 0;
        const size_t superpixel = evidence.superpixels(x, y);
        const int label = labels.planes[superpixel];
        if (label >= 0 &&
            labels.evidence[superpixel] == LabelEvidence::kMeasured) {
          const float depth = camera_planes[label].Depth(ray);
          result[k].on_planes +=
              std::abs(depth - intersection.depth) > gap ? 1 : 0;
        }
      }
    }
  }
  return result;
}

}  // namespace tsar
