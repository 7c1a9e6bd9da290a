// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/scene_model_layout.h"

#include <cstddef>

namespace tsar {
namespace {

template <typename Matrix, size_t kSize>
void Store(const Matrix& matrix, std::array<double, kSize>* values) {
  static_assert(Matrix::SizeAtCompileTime == kSize);
  Eigen::Map<Matrix>(values->data()) = matrix;
}

template <typename Matrix, size_t kSize>
void Load(const std::array<double, kSize>& values, Matrix* matrix) {
  static_assert(Matrix::SizeAtCompileTime == kSize);
  *matrix = Eigen::Map<const Matrix>(values.data());
}

StoredPlane ToStored(const ModelPlane& plane) {
  StoredPlane stored = {};
  Store(plane.plane.normal, &stored.normal);
  stored.offset = plane.plane.offset;
  Store(plane.center, &stored.center);
  Store(plane.axis_s, &stored.axis_s);
  Store(plane.axis_t, &stored.axis_t);
  Store(plane.covariance, &stored.covariance);
  stored.support = plane.support;
  stored.component = plane.component;
  stored.frame = plane.frame;
  stored.axis = plane.axis;
  return stored;
}

ModelPlane FromStored(const StoredPlane& stored) {
  ModelPlane plane;
  Load(stored.normal, &plane.plane.normal);
  plane.plane.offset = stored.offset;
  Load(stored.center, &plane.center);
  Load(stored.axis_s, &plane.axis_s);
  Load(stored.axis_t, &plane.axis_t);
  Load(stored.covariance, &plane.covariance);
  plane.support = stored.support;
  plane.component = stored.component;
  plane.frame = stored.frame;
  plane.axis = stored.axis;
  return plane;
}

StoredCylinder ToStored(const ModelCylinder& cylinder) {
  StoredCylinder stored = {};
  Store(cylinder.point, &stored.point);
  Store(cylinder.frame.along, &stored.along);
  Store(cylinder.frame.across, &stored.across);
  stored.radius = cylinder.radius;
  stored.min_height = cylinder.min_height;
  stored.max_height = cylinder.max_height;
  Store(cylinder.covariance, &stored.covariance);
  return stored;
}

ModelCylinder FromStored(const StoredCylinder& stored) {
  ModelCylinder cylinder;
  Load(stored.point, &cylinder.point);
  Load(stored.along, &cylinder.frame.along);
  Load(stored.across, &cylinder.frame.across);
  cylinder.radius = stored.radius;
  cylinder.min_height = stored.min_height;
  cylinder.max_height = stored.max_height;
  Load(stored.covariance, &cylinder.covariance);
  return cylinder;
}

}  // namespace

PlaneArrays ToPlaneArrays(const SceneModel& model) {
  PlaneArrays arrays;
  for (const ModelPlane& plane : model.planes) {
    arrays.planes.push_back(ToStored(plane));
  }
  for (const Eigen::Matrix3d& frame : model.frames) {
    Store(frame, &arrays.frames.emplace_back());
  }
  for (const ModelCylinder& cylinder : model.cylinders) {
    arrays.cylinders.push_back(ToStored(cylinder));
  }
  return arrays;
}

LabelArrays ToLabelArrays(const SceneModel& model) {
  LabelArrays arrays;
  for (const auto& [image, view] : model.views) {
    arrays.views.push_back({image, static_cast<uint32_t>(view.planes.size())});
    arrays.planes.insert(
        arrays.planes.end(), view.planes.begin(), view.planes.end());
    arrays.evidence.insert(
        arrays.evidence.end(), view.evidence.begin(), view.evidence.end());
    arrays.qualities.insert(
        arrays.qualities.end(), view.qualities.begin(), view.qualities.end());
  }
  return arrays;
}

SceneModel FromPlaneArrays(const PlaneArrays& arrays) {
  SceneModel model;
  for (const StoredPlane& plane : arrays.planes) {
    model.planes.push_back(FromStored(plane));
  }
  for (const StoredFrame& frame : arrays.frames) {
    Load(frame, &model.frames.emplace_back());
  }
  for (const StoredCylinder& cylinder : arrays.cylinders) {
    model.cylinders.push_back(FromStored(cylinder));
  }
  return model;
}

std::optional<std::map<int, ViewLabels>> FromLabelArrays(
    const LabelArrays& arrays) {
  std::map<int, ViewLabels> views;
  size_t begin = 0;
  int64_t previous = -1;
  for (const StoredView& view : arrays.views) {
    if (view.image <= previous ||
        view.num_labels > arrays.planes.size() - begin) {
      return std::nullopt;
    }
    previous = view.image;
    const auto first = static_cast<ptrdiff_t>(begin);
    const auto last = static_cast<ptrdiff_t>(begin + view.num_labels);
    views[view.image] = {
        {arrays.planes.begin() + first, arrays.planes.begin() + last},
        {arrays.evidence.begin() + first, arrays.evidence.begin() + last},
        {arrays.qualities.begin() + first, arrays.qualities.begin() + last}};
    begin += view.num_labels;
  }
  if (begin != arrays.planes.size()) {
    return std::nullopt;
  }
  return views;
}

}  // namespace tsar
