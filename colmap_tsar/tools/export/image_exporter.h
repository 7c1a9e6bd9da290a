// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/export_format.h"
#include "colmap_tsar/tools/export/map_levels.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {

// The description of one exported image.
struct ExportedImage {
  int width = 0;  // Size of its maps.
  int height = 0;
  DepthStatistics depth;  // As in the workspace.
  // The number of depths that the format cannot represent.
  int64_t num_out_of_range = 0;
  // The path in the export by kind of map or "photo".
  std::map<std::string, std::string> files;
};

// The description of an image with this depth map, still without files.
inline ExportedImage Describe(const Image<float>& depth) {
  return {depth.Width(), depth.Height(), MeasureDepth(depth), 0, {}};
}

// Writes one format into a folder. Must not outlive its workspace.

class ImageExporter {
 public:
  virtual ~ImageExporter() = default;

  // Describes the files of each kind of map, for the manifest.
  virtual nlohmann::ordered_json DescribeMaps() const = 0;

  // Writes the files of one image of the sparse model; thread-safe.
  virtual ExportedImage Export(int image) const = 0;

  // Writes the files of the full export after all images, and warns users.
  // images and exported: the arguments and results of Export().
  virtual void Finish(const std::vector<int>& images,
                      const std::vector<ExportedImage>& exported) const = 0;
};

// Exporter of all maps of each image in the formats kNpy, kExr and kPng16: in a
// folder for each kind of map, named by the image with its extension.
// depth_scale: units of the sparse model per step of a depth in 16 bits; depths
// that do not round to 1 to 65535 steps are left out. Sigmas have steps of a
// hundredth of that and are clamped to the largest. Errors as RequireExr().
std::unique_ptr<ImageExporter> MakeMapExporter(const Workspace& workspace,
                                               const ContainedPath& folder,
                                               ExportFormat format,
                                               double depth_scale);

// Exporter for nerfstudio: transforms.json with all images of the sparse model,
// these in images/, their depth in depths/, as arrays in thousandths of a unit
// of the sparse model (nerfstudio interprets stored depths as millimeters), and
// their normals in normals/, as pictures of the size of the image: of red,
// green and blue, 127.5 + 127.5 n, with n in the frame of the sparse model's
// camera. An image without maps gets no depth and no normal anywhere, since
// nerfstudio requires depth for all images or none; depth 0 and normal (0, 0,
// 0) are none. The cameras are those of the images, with the frame of OpenGL,
// and the world is that of the sparse model. cloud: a PLY file in that world,
// which is copied for trainers to start from; empty: none.
//
// Throws Error kNotFound where the cloud has no points, and those of
// ReadPlyCloud() and RequireUtf8Names().
std::unique_ptr<ImageExporter> MakeNerfstudioExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const std::filesystem::path& cloud);

// The inverse depth of a level of 65536, common to all images: the trainer
// drops images whose scale differs from the median by more than a factor of
// five. It is that of the nearest depth or of a sixteenth of the median depth,
// whichever is farther, so that single near pixels do not coarsen the levels of
// all others. depth: statistics of all images.
double InverseDepthScale(const DepthStatistics& depth);

// Exporter for the trainer of 3D Gaussian splatting (graphdeco-inria), which
// reads a COLMAP folder: images/, the sparse model in sparse/0, inverse depths
// of 16 bits in depths/STEM.png and sparse/0/depth_params.json, with inverse
// depth = level / 65536 * scale + offset. An image without depth gets zeros and
// the scale 0, which the trainer skips. Pixels without depth are 0; the trainer
// has no mask for these, so depth_masks/STEM.png (255: depth) is for other
// programs. Depths nearer than 1 / scale become the largest level. Errors as
// RequireUtf8Names() and UniqueStems().
std::unique_ptr<ImageExporter> MakeGaussianSplattingExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const DepthStatistics& depth);

}  // namespace tsar
