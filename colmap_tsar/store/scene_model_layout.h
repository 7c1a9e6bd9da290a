// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/scene_model.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

namespace tsar {

static_assert(sizeof(LabelEvidence) == 1);
static_assert(sizeof(LabelQuality) == 5 &&
              std::is_trivially_copyable_v<LabelQuality>);

// Matrices are stored column by column.
struct StoredPlane {
  std::array<double, 3> normal;
  double offset;
  std::array<double, 3> center;
  std::array<double, 3> axis_s;
  std::array<double, 3> axis_t;
  std::array<double, 9> covariance;
  double support;
  int32_t component;
  int32_t frame;
  int32_t axis;
  int32_t unused;
};
static_assert(sizeof(StoredPlane) == 200 &&
              std::is_trivially_copyable_v<StoredPlane>);

using StoredFrame = std::array<double, 9>;

struct StoredCylinder {
  std::array<double, 3> point;
  std::array<double, 3> along;
  std::array<double, 3> across;
  double radius;
  double min_height;
  double max_height;
  std::array<double, 9> covariance;
};
static_assert(sizeof(StoredCylinder) == 168 &&
              std::is_trivially_copyable_v<StoredCylinder>);

struct StoredView {
  int32_t image;
  uint32_t num_labels;
};
static_assert(sizeof(StoredView) == 8 &&
              std::is_trivially_copyable_v<StoredView>);

// The two parts of the file (scene_model_file.h) as arrays of what is stored.
struct PlaneArrays {
  std::vector<StoredPlane> planes;
  std::vector<StoredFrame> frames;
  std::vector<StoredCylinder> cylinders;
};
struct LabelArrays {
  std::vector<StoredView> views;
  std::vector<int32_t> planes;
  std::vector<LabelEvidence> evidence;
  std::vector<LabelQuality> qualities;
};

PlaneArrays ToPlaneArrays(const SceneModel& model);
// All of the model but its views.
SceneModel FromPlaneArrays(const PlaneArrays& arrays);

LabelArrays ToLabelArrays(const SceneModel& model);
// Nothing where the labels are not those of the views, each of which is there
// once, in order.
std::optional<std::map<int, ViewLabels>> FromLabelArrays(
    const LabelArrays& arrays);

}  // namespace tsar
