// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/io/stored_camera.h"

#include <vector>

namespace tsar {

// A camera that another program kept, and the image whose it should be.
struct AssignedCamera {
  int image = -1;  // Index into SparseModel::images.
  StoredCamera camera;
};

// Makes sure that the cameras of another program are those of the images that
// its maps are taken for: the most likely mistake is another order of the
// images. A camera fits when its rotation is within 1 degree, its center times
// `scale` within 1 % of the extent of all camera centers, and its ratios of
// principal point and focal lengths, which do not depend on the image's size,
// within 2 %. Where images stand closer than that, none may fit ten times as
// well as the one that is meant.
//
// Throws Error kMismatch that names a camera's file and the image, and tells
// which it is: other units of the whole model (with the scale to give), the
// camera of another image, or none of the workspace's.
void CheckCameras(const std::vector<AssignedCamera>& cameras,
                  const SparseModel& model,
                  double scale);

}  // namespace tsar
