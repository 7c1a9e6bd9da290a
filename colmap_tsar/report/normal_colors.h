// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

namespace tsar {

// Red, green and blue grow with how far a normal points right, up and to the
// camera; 0 (no normal) is black. Normals in the camera's frame, of unit
// length.
Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals);

}  // namespace tsar
