// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/tools/import/external_maps.h"

#include <filesystem>
#include <vector>

namespace tsar {

struct MatchOptions {
  ExternalFormat format = ExternalFormat::kAcm;
  // The folder with the maps or, for kAcm and kApd, its parent with cams/.
  std::filesystem::path input_path;
  // The folder of normals, only for kDepth; empty if there are none.
  std::filesystem::path normal_path;
  // The one of the two depth maps of ACMM and its successors to import.
  MapType type = MapType::kGeometric;
  // A file with one image name per line: the images 0, 1, 2, ... If given, only
  // the numbers in names of files and folders are used. Without it, kAcm and
  // kApd number the images in the order of COLMAP's image ids, as colmap2mvsnet
  // does.
  std::filesystem::path image_list;
};

struct MatchedMaps {
  std::vector<ExternalFiles>
      files;                  // By ascending image; each image at most once.
  int num_without_image = 0;  // Maps of images that are not in the model.
};

// Finds each image's maps.
//
// kAcm, kApd: folders whose names end in a number, such as 2333_00000012, with
// depths_geom.dmb (for kGeometric, if it exists) or depths.dmb, and optionally
// normals.dmb and ../../cams/00000012_cam.txt. The number is the image's index
// in the order. If both depth maps exist, normals belong to the geometric one
// and are left out for the other.
//
// kOpenMvs: files depth0012.dmap, matched by the stored image name: the longest
// image name that it ends in, otherwise the only one of the same stem.
//
// kDepth: files named like the images, including subfolders, with or without
// the image's extension before their own.
//
// Throws Error: kNotFound (no folder, no maps, no image list), kMismatch (two
// maps for one image, an index out of range, a name that matches several images
// or none; the list is empty, or a line of it names no image or one twice),
// kUnsupported (the path of a map is a folder, a FIFO, a device or a dangling
// link: its image would count as one without a map).
MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model);

}  // namespace tsar
