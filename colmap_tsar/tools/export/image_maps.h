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

// Conversion of maps to integer levels, for pictures: value = scale * level +
// offset.

constexpr int kMaxLevel = 65535;

// Levels of scale `step`. 0 stands for no depth, and for depths outside of the
// levels 1 to kMaxLevel after rounding, which are counted.
Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range);

// Levels of scale `step`, clamped to [1, kMaxLevel]. 0 stands for no depth.
Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step);

constexpr double kNormalScale = 1.0 / 32767.0;
constexpr double kNormalOffset = -1.0;
Image<Rgb16> NormalLevels(const Image<Vec3f>& normal);

// The confidences of a confidence map's levels.
Image<float> ConfidencesOf(const Image<uint8_t>& levels);

// The smallest step of one significant digit at which this depth fits a level.
double StepFor(double depth);

// The current maps of one image, 0 where the image is masked; all of one size.
// Those after `normal` are empty if the image has none.
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

// Throws Error: kMismatch (a map's aspect ratio is not the image's, or its size
// not the depth map's), and those of the readers and Workspace::ReadMask.
ImageMaps ReadImageMaps(const Workspace& workspace, int image);

// The depth and the normal map before refinement, 0 where the image is masked;
// no other maps. Throws what Workspace::ReadOriginalMaps and ReadMask throw.
ImageMaps ReadOriginalImageMaps(const Workspace& workspace, int image);

// Reads the depth map alone; errors as ReadImageMaps().
Image<float> ReadImageDepth(const Workspace& workspace, int image);

// Reads the normal map alone, which has to be of the size of the depth map;
// errors as ReadImageMaps().
Image<Vec3f> ReadImageNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth);

// Statistics of the valid depths of a map; 0 if there are none.
struct DepthStatistics {
  int64_t num_depths = 0;
  float nearest = 0.f;
  float farthest = 0.f;
  float median = 0.f;
};

DepthStatistics MeasureDepth(const Image<float>& depth);

// Joins the statistics of maps: the nearest and farthest of all, the median of
// the medians.
DepthStatistics JoinStatistics(const std::vector<DepthStatistics>& maps);

}  // namespace tsar
