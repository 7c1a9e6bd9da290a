// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/map_conventions.h"

#include <filesystem>
#include <optional>

namespace tsar {

// The formats of maps, by program.
enum class ExternalFormat {
  kAcm,      // .dmb of Gipuma, ACMH, ACMM, ACMP, ACMMP.
  kApd,      // .dmb or .bin of APD and its successors.
  kOpenMvs,  // .dmap of OpenMVS.
  kDepth,    // Depth images and arrays of any program or sensor.
};

// The files of another program for one image; all but depth may be empty.
struct ExternalFiles {
  int image = -1;  // Index into SparseModel::images.
  std::filesystem::path depth;
  std::filesystem::path normal;
  std::filesystem::path camera;
};

// The content of such files, unconverted.
struct ExternalMaps {
  Image<float> depth;       // In the other program's units; 0 = none.
  bool is_integer = false;  // Depth is stored in integers.
  Image<Vec3f> normal;      // Empty or of the size of the depth map.
  std::optional<StoredCamera> camera;
};

// Reads the files. Throws the errors of the readers of the formats, and Error
// kMismatch if the maps of an image differ in size.
ExternalMaps ReadExternalMaps(const ExternalFiles& files,
                              ExternalFormat format);

// The maps to write to the workspace; see map_io.h.
struct ImportedMaps {
  Image<float> depth;
  Image<Vec3f> normal;
};

// Converts maps to the workspace's units and frames. Unit normals in the camera
// frame keep every bit; others are rotated, normalized and oriented towards the
// camera. Depths without a normal get one from the depths around (see
// NormalsFromDepth).
//
// camera: that of the image at any size. scale: model units per stored unit of
// depth. frame: that of the normals.
ImportedMaps ConvertMaps(const ExternalMaps& external,
                         const Camera& camera,
                         double scale,
                         NormalFrame frame);

// Depths times a scale; those that overflow become 0.
Image<float> ScaledDepth(const Image<float>& depth, double scale);

// Computes the normals of a depth map (z in the camera frame, 0 = none): unit
// vectors in the camera frame, towards the camera; (0, 0, 0) if undetermined.
//
// A plane's inverse depth is linear in the pixel's position, so its differences
// give the exact normal. Central differences are used along each axis; a
// one-sided difference if the other neighbor has no depth, differs by more than
// 5 % of the depth, or has more than twice the other difference beyond noise,
// as at creases and occlusion boundaries. Without a neighbor along an axis:
// none.
Image<Vec3f> NormalsFromDepth(const Image<float>& depth,
                              const Intrinsics& intrinsics);

}  // namespace tsar
