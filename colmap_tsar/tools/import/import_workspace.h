// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/tools/import/import_summary.h"
#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <functional>

namespace tsar {

// The frame of another program's normals.
enum class NormalFrame {
  kAuto,  // World for kAcm and kApd, camera for the others.
  kWorld,
  kCamera,
};

struct ImportOptions {
  std::filesystem::path workspace_path;
  // The files to import; match.type is also the type of the written maps.
  MatchOptions match;
  // Model units per stored unit of depth. 0: 0.001 for depth images of
  // integers, otherwise 1.
  double depth_scale = 0.0;
  // Whether each image gets a separate scale from its sparse points.
  bool scale_to_sparse = false;
  // Whether to reject depths in other units than the sparse points.
  bool check_scale = true;
  NormalFrame normal_frame = NormalFrame::kAuto;
  // Whether to import costs. Costs of other programs differ from those of
  // tsar_refine: they may include geometric terms, and are noise in textureless
  // areas.
  bool import_costs = false;
  // Whether to replace maps that another program wrote, which are kept.
  bool overwrite = false;
};

// Imports the maps of another program into a dense workspace, which needs only
// images/ and sparse/; the rest is created. Everything is read and checked
// before the first file is written. The maps' size may differ from the image's,
// as COLMAP's may.
//
// Throws Error, with nothing written: those of MatchImages, ReadExternalMaps,
// CheckCameras, RequireUnrefined, RequireNoForeignMaps, ReadSparseModel and
// WorkspaceLock, and kMismatch if a map's aspect ratio is not that of its
// image, depths are in other units than the sparse points, normals are in
// another frame than stated, or an image has too few sparse points for
// scale_to_sparse.
//
// should_stop: if given, called before each image. Once it returns true,
// kInterrupted is thrown; imported images remain, and the same call starts
// over.
ImportSummary ImportWorkspace(const ImportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop = {});

}  // namespace tsar
