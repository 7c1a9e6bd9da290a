// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/float_map.h"

#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>

namespace tsar {

// Depth maps, normal maps and cameras of other programs. All functions take the
// bytes of a file and its name, for messages. They throw Error kCorrupt where
// the header is not of the described form, the length is not exactly what it
// says, or a camera is invalid.

// Reads a .dmb file of the family of Gipuma (ACMH, ACMM, ACMP, ACMMP): int32
// type (1 = float), height, width, channels; then float32 row by row, the
// channels of a pixel side by side. Depth is z in the camera frame, one
// channel; normals have three, in the world frame. Pixels have integer
// coordinates and K is used as it is, as in COLMAP's dense stage.
FloatMap ParseDmb(std::span<const uint8_t> bytes, const std::string& name);

// Reads a .dmb or .bin file of APD and its successors: an OpenCV matrix as
// int32 version, rows, columns, OpenCV type (5 = one float, 21 = three), then
// the rows. Some versions omit the first word, which the file's length reveals.
// Depth and normals are as in ParseDmb. Throws Error kCorrupt also if the
// length fits both forms, or the matrix is not of floats.
FloatMap ParseApdMap(std::span<const uint8_t> bytes, const std::string& name);

// The calibration that another program stored with a map, in its own units:
// x_cam = rotation * (x_world - center).
struct StoredCamera {
  std::string file;  // For messages.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  // Intrinsics of an image whose size may be unknown.
  double fx = 1.0;
  double fy = 1.0;
  double cx = 0.0;
  double cy = 0.0;
};

// Reads a cams/%08d_cam.txt of MVSNet and its successors: the word "extrinsic",
// 4 x 4 numbers [R t; 0 1] with x_cam = R x + t, the word "intrinsic", 3 x 3
// numbers K; the depth ranges that follow are ignored.
StoredCamera ParseCamFile(std::span<const uint8_t> bytes,
                          const std::string& name);

// The content of a .dmap file of OpenMVS without its confidences, whose meaning
// has changed between versions, and which are unbounded after its filter.
struct Dmap {
  std::string image_name;  // As stored: absolute, or relative to its project.
  StoredCamera camera;
  Image<float> depth;   // z in the camera frame; 0 = none.
  Image<Vec3f> normal;  // Camera frame; empty where the file has none.
};

// Reads a .dmap file: "DR", uint8 content (1 depth, 2 normals, 4 confidence, 8
// views), uint8 padding, uint32 width and height of the image and of the map,
// float32 smallest and largest depth; uint16 length and the image's name;
// uint32 number of ids and these (the first is the image, the others its
// neighbors); float64 K, R (world to camera), C (center), row by row; then
// float32 depths, 3 x float32 normals, float32 confidences and 4 x uint8 views,
// each only if the content flags it.
//
// In OpenMVS, pixel centers have integer coordinates, as in COLMAP's dense
// stage. Since October 2023 its importer therefore moves COLMAP's principal
// point by half a pixel, which COLMAP's dense stage does not: its rays are half
// a pixel off those of OpenMVS. The map's pixels show the same points in both,
// so depths are copied pixel by pixel without resampling.
//
// Throws Error kUnsupported where the file has no depth.
Dmap ParseDmap(std::span<const uint8_t> bytes, const std::string& name);

// Reads only the name of the image, from the first kMaxDmapNameEnd bytes or
// more.
constexpr size_t kMaxDmapNameEnd = 30 + 65535;
std::string ParseDmapImageName(std::span<const uint8_t> bytes,
                               const std::string& name);

}  // namespace tsar
