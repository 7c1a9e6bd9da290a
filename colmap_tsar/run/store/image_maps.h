// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace tsar {

// The current maps of one image, 0 where the image is masked; all of one size.
// Those after `normal` are empty if the image has none.
struct ImageMaps {
  Image<float> depth;         // See map_io.h.
  Image<Vec3f> normal;        // See map_io.h.
  Image<uint8_t> confidence;  // See ToConfidenceLevel().
  Image<float> sigma;         // See map_files.h.
  Image<uint8_t> provenance;  // See refined_maps.h.
  Image<uint16_t> planes;     // See refined_maps.h.
};

// Sets the masked pixels of ImageMaps or RefinedMaps to 0.
template <typename Maps>
void ClearMaskedPixels(const Image<uint8_t>& mask, Maps* maps) {
  ClearMasked(mask, &maps->depth);
  ClearMasked(mask, &maps->normal);
  ClearMasked(mask, &maps->confidence);
  ClearMasked(mask, &maps->sigma);
  ClearMasked(mask, &maps->provenance);
  ClearMasked(mask, &maps->planes);
}

// The images that have a depth and a normal map of the workspace's type, as
// indices into its sparse model, ascending.
std::vector<int> FindImagesWithMaps(const Workspace& workspace);

// The images whose maps of the workspace's type were refined, as indices into
// its sparse model, ascending. Throws Error kNotFound where there are none.
std::vector<int> RequireRefinedImages(const Workspace& workspace);

// Opens a workspace to read its maps. type: if not given, geometric maps, or
// photometric ones if only those were refined or exist. Errors as Workspace.
Workspace OpenWorkspaceWithMaps(const std::filesystem::path& root,
                                std::optional<MapType> type);

// Maps that were not refined are read by their conventions. Throws Error:
// kMismatch (a map's aspect ratio is not the image's, or its size
// not the depth map's), and those of the readers and Workspace::ReadMask.
// with_labels: also the maps of provenance and planes.
ImageMaps ReadImageMaps(const Workspace& workspace,
                        int image,
                        bool with_labels = true);

// The depth and the normal map before refinement, 0 where the image is masked;
// no other maps. Throws what Workspace::ReadOriginalMaps and ReadMask throw.
ImageMaps ReadOriginalImageMaps(const Workspace& workspace, int image);

// Warns of maps that do not follow COLMAP's conventions, see map_conventions.h.
// Throws what Workspace::OpenOriginalMaps throws.
void WarnOfConventions(const Workspace& workspace,
                       const std::vector<int>& images);

// Reads the depth map alone; errors as ReadImageMaps().
Image<float> ReadImageDepth(const Workspace& workspace, int image);

// Reads the normal map alone, which has to be of the size of the depth map;
// errors as ReadImageMaps().
Image<Vec3f> ReadImageNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth);

// Calls function(i) for each index i in `images`, from several threads;
// rethrows the first exception. For work that holds all maps of an image.
// num_threads: -1 for one per core; fewer where the images are so large that
// half of the main memory would not suffice.
void ForEachImage(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads,
                  const std::function<void(size_t)>& function);

}  // namespace tsar
