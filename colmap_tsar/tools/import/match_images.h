// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/tools/import/external_maps.h"

#include <filesystem>
#include <vector>

namespace tsar {

// How images are numbered by programs that call them 00000000, 00000001, ...
enum class IndexOrder {
  kImageId,  // By COLMAP's image id, as colmap2mvsnet does.
  kName,     // By the image's name.
};

struct MatchOptions {
  ExternalFormat format = ExternalFormat::kAcm;
  // The folder to look in: that with the maps, or, for kAcm and kApd, the one
  // above, which holds cams/ and the program's folder.
  std::filesystem::path input_path;
  // Only for kDepth; empty: there are no normals.
  std::filesystem::path normal_path;
  // Which of the two depth maps of ACMM and its successors is taken.
  MapType type = MapType::kGeometric;
  IndexOrder index_order = IndexOrder::kImageId;
  // A file with one image name per line: the images 0, 1, 2, ... Where it is
  // given, numbers in the names of files and folders count, and nothing else.
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
// depths_geom.dmb (for kGeometric, where there is one) or depths.dmb, and where
// they exist normals.dmb, costs.dmb and ../../cams/00000012_cam.txt. The number
// is the image's place in the order. Where both depth maps exist, normals and
// costs belong to the geometric one and are left out for the other.
//
// kOpenMvs: files depth0012.dmap, by the name of the image that they hold: the
// longest image name that it ends in, otherwise the only one of the same name
// but for folder and extension.
//
// kDepth: files called as the images are, with subfolders, with the image's
// extension before their own or without.
//
// Throws Error: kNotFound (no folder, no maps), kMismatch (two maps for one
// image, a number beyond the images, a name that fits several or none),
// kUnsupported (what has the name of a map is no file), and for the list
// kNotFound and kMismatch with the line.
MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model);

}  // namespace tsar
