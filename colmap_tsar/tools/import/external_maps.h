// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/stored_camera.h"

#include <filesystem>
#include <optional>

namespace tsar {

// Whose maps they are.
enum class ExternalFormat {
  kAcm,      // .dmb of Gipuma, ACMH, ACMM, ACMP, ACMMP.
  kApd,      // .dmb or .bin of APD and its successors.
  kOpenMvs,  // .dmap of OpenMVS.
  kDepth,    // Depth images and arrays of any program or sensor.
};

// The files that another program wrote for one image. All paths but the first
// may be empty.
struct ExternalFiles {
  int image = -1;  // Index into SparseModel::images.
  std::filesystem::path depth;
  std::filesystem::path normal;
  std::filesystem::path cost;
  std::filesystem::path camera;
};

// What such files hold, as they say it.
struct ExternalMaps {
  Image<float> depth;       // In the other program's units; 0 = none.
  bool is_integer = false;  // The depth is stored in integers.
  Image<Vec3f> normal;      // Empty or of the size of the depth map.
  Image<float> cost;        // Empty or of the size of the depth map.
  std::optional<StoredCamera> camera;
};

// Reads the files. Throws what the readers of the formats throw, and Error
// kMismatch where the maps of an image differ in size.
ExternalMaps ReadExternalMaps(const ExternalFiles& files,
                              ExternalFormat format);

// What is written to the workspace; see map_io.h.
struct ImportedMaps {
  Image<float> depth;
  Image<Vec3f> normal;
  // Two channels, the smallest and the second smallest cost in [0, 2]; 2 is "no
  // evidence". Empty where there are no costs.
  PlanarMap cost;
};

// How to convert the maps of one image.
struct ConvertOptions {
  double scale = 1.0;             // Model units per stored unit of depth.
  bool normals_in_world = false;  // Otherwise in the camera frame.
  bool use_costs = false;
};

// Brings maps into the workspace's units and frames. Normals of unit length in
// the camera frame keep every bit; others are rotated, normalized and turned
// towards the camera. Depths without a normal get one from the depths around
// (see NormalsFromDepth). Costs outside [0, 2] become 2, and so does the second
// smallest cost, which no other program tells.
//
// camera: that of the image, of any size.
ImportedMaps ConvertMaps(const ExternalMaps& external,
                         const Camera& camera,
                         const ConvertOptions& options);

// Depths times a scale; those that leave the range of numbers become 0.
Image<float> ScaledDepth(const Image<float>& depth, double scale);

// How many of the normals at pixels with depth look towards the camera, if they
// are in the one frame or in the other. With the frame that is right it is all
// of them, or none where they point into the surfaces.
struct NormalFacing {
  int64_t num_normals = 0;
  int64_t num_facing_in_camera = 0;
  int64_t num_facing_in_world = 0;
};
NormalFacing CountFacing(const ExternalMaps& external, const Camera& camera);

}  // namespace tsar
