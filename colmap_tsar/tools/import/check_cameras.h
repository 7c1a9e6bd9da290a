// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/sparse_model.h"

#include <vector>

namespace tsar {

// A camera stored by another program, and the image to which it was assigned.
struct AssignedCamera {
  int image = -1;  // Index into SparseModel::images.
  StoredCamera camera;
};

// Checks that the cameras of another program match the images to which its maps
// were assigned: the most likely mistake is another order of the images. A
// camera matches if its rotation is within 1 degree, its center times `scale`
// within 1 % of the extent of all camera centers, and its ratios of principal
// point and focal lengths, which do not depend on the image's size, within 2 %.
// For closer images, none may match ten times as well as the assigned one.
//
// Throws Error kMismatch with a camera's file, the image and the cause: other
// units of the model (with the scale to use), the camera of another image, or
// none of the workspace's.
void CheckCameras(const std::vector<AssignedCamera>& cameras,
                  const SparseModel& model,
                  double scale);

}  // namespace tsar
