// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_fault.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/LU>

namespace tsar {
namespace {

bool IsRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kTolerance = 1e-6;
  return (matrix.transpose() * matrix - Eigen::Matrix3d::Identity())
                 .cwiseAbs()
                 .maxCoeff() < kTolerance &&
         matrix.determinant() > 0.0;
}

bool HasUnitVectors(const ModelPlane& plane) {
  Eigen::Matrix3d axes;
  axes << plane.axis_s, plane.axis_t, plane.plane.normal;
  // Both directions of the normal represent the same plane.
  axes.col(2) *= axes.determinant() < 0.0 ? -1.0 : 1.0;
  return axes.allFinite() && IsRotation(axes);
}

// Unknown variances are infinite, with covariances of 0.
bool IsCovariance(const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d covariances = covariance;
  covariances.diagonal().setZero();
  return covariances.allFinite() &&
         (covariance.diagonal().array() >= 0.0).all();
}

std::optional<std::string> FindPlaneFault(const ModelPlane& plane,
                                          size_t num_frames) {
  if (!HasUnitVectors(plane)) {
    return "a plane whose normal and axes are not unit vectors at right angles";
  }
  if (!std::isfinite(plane.plane.offset) || !plane.center.allFinite()) {
    return "a plane whose position is no number";
  }
  if (!IsCovariance(plane.covariance)) {
    return "a plane's invalid covariance";
  }
  if (!std::isfinite(plane.support) || plane.support < 0.0 ||
      plane.component < 0) {
    return "a plane's invalid support or component";
  }
  const bool is_free = plane.frame == -1 && plane.axis == -1;
  const bool is_in_frame = plane.frame >= 0 &&
                           static_cast<size_t>(plane.frame) < num_frames &&
                           plane.axis >= 0 && plane.axis < 3;
  if (!is_free && !is_in_frame) {
    return "a plane along an axis that no frame has";
  }
  return std::nullopt;
}

std::optional<std::string> FindCylinderFault(const ModelCylinder& cylinder) {
  Eigen::Matrix3d axes;
  axes << cylinder.frame.across, cylinder.frame.Third(), cylinder.frame.along;
  if (!axes.allFinite() || !IsRotation(axes)) {
    return "a cylinder whose directions are not unit vectors at right angles";
  }
  if (!cylinder.point.allFinite() || !std::isfinite(cylinder.radius) ||
      !(cylinder.radius > 0.0) || !std::isfinite(cylinder.min_height) ||
      !std::isfinite(cylinder.max_height) ||
      !(cylinder.min_height < cylinder.max_height)) {
    return "a cylinder's invalid place or size";
  }
  if (!cylinder.covariance.allFinite() || !IsCovariance(cylinder.covariance)) {
    return "a cylinder's invalid covariance";
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> FindSceneModelFault(const SceneModel& model) {
  for (const Eigen::Matrix3d& frame : model.frames) {
    if (!frame.allFinite() || !IsRotation(frame)) {
      return "a frame that is no rotation";
    }
  }
  for (const ModelPlane& plane : model.planes) {
    if (auto fault = FindPlaneFault(plane, model.frames.size())) {
      return fault;
    }
  }
  for (const ModelCylinder& cylinder : model.cylinders) {
    if (auto fault = FindCylinderFault(cylinder)) {
      return fault;
    }
  }
  const auto num_planes = static_cast<int64_t>(model.planes.size());
  for (const auto& [image, view] : model.views) {
    if (image < 0 || view.planes.size() != view.evidence.size() ||
        view.planes.size() != view.qualities.size()) {
      return "a view's labels that do not fit it";
    }
    if (!std::ranges::all_of(view.planes, [&](int plane) {
          return plane >= -1 && plane < num_planes;
        })) {
      return "a label that no plane has";
    }
    if (!std::ranges::all_of(view.evidence, [](LabelEvidence evidence) {
          return evidence <= LabelEvidence::kMeasured;
        })) {
      return "a label's unknown evidence";
    }
  }
  return std::nullopt;
}

}  // namespace tsar
