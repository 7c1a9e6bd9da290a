// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/value_files.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Maps in whole numbers, for pictures. A value is scale times its level, plus
// offset.

constexpr int kMaxLevel = 65535;

// Scale: step. 0 stands for no depth, and for depths that no level from 1 to
// kMaxLevel is the nearest of, which are counted.
Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range);

// Scale: step. 0 stands for no depth alone; what no level is the nearest of
// becomes 1 or kMaxLevel.
Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step);

constexpr double kNormalScale = 1.0 / 32767.0;
constexpr double kNormalOffset = -1.0;
Image<Rgb16> NormalLevels(const Image<Vec3f>& normal);

// Those of a confidence map.
Image<float> ConfidencesOf(const Image<uint8_t>& levels);

// The smallest step of one digit at which a level holds this depth.
double StepFor(double depth);

// The maps of one image as they are in the workspace now, 0 where the image is
// masked; all of one size.
// Those below `normal` are empty where the image has none.
struct ImageMaps {
  Image<float> depth;         // See map_io.h.
  Image<Vec3f> normal;        // See map_io.h.
  Image<uint8_t> confidence;  // See confidence_level.h.
  Image<float> sigma;         // See sigma_map.h.
  Image<uint8_t> provenance;  // See refined_maps.h.
  Image<uint16_t> planes;     // See refined_maps.h.
};

// The images that have a depth and a normal map of the workspace's type, as
// indices into its sparse model, ascending.
std::vector<int> FindImagesWithMaps(const Workspace& workspace);

// Throws Error: kMismatch (a map is not of the image's shape, or of another
// size than the depth map), and what the readers and Workspace::ReadMask throw.
ImageMaps ReadImageMaps(const Workspace& workspace, int image);

// The depth map alone; errors as ReadImageMaps().
Image<float> ReadImageDepth(const Workspace& workspace, int image);

// Of the pixels of a map that have a depth; 0 where there are none.
struct DepthStatistics {
  int64_t num_depths = 0;
  float nearest = 0.f;
  float farthest = 0.f;
  float median = 0.f;
};

DepthStatistics MeasureDepth(const Image<float>& depth);

// Of all maps: nearest and farthest of all, the median of the medians.
DepthStatistics JoinStatistics(const std::vector<DepthStatistics>& maps);

}  // namespace tsar
