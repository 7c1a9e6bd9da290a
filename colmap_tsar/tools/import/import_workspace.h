// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/tools/import/import_summary.h"
#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <functional>

namespace tsar {

// In which frame another program's normals are.
enum class NormalFrame {
  kAuto,  // World for kAcm and kApd, camera for the others.
  kWorld,
  kCamera,
};

struct ImportOptions {
  std::filesystem::path workspace_path;
  // What to import; match.type is the type of maps to write, too.
  MatchOptions match;
  // Model units per stored unit of depth. 0: 0.001 for depth images of
  // integers, otherwise 1.
  double depth_scale = 0.0;
  // Give each image a scale of its own, by its sparse points.
  bool scale_to_sparse = false;
  // Refuse depths that are in other units than the sparse points.
  bool check_scale = true;
  NormalFrame normal_frame = NormalFrame::kAuto;
  // Take costs over, too. What other programs write is not what tsar_refine
  // would compute: they may hold terms of geometry, and where the image has no
  // texture they are noise.
  bool import_costs = false;
  // Replace maps that another program wrote; they are kept.
  bool overwrite = false;
};

// Imports the maps of another program into a dense workspace, which needs
// images/ and sparse/ alone; the rest is made. Everything is read and checked
// before the first file is written. The maps have their own size, which may
// differ from the image's, as COLMAP's may.
//
// Throws Error, with nothing written: what MatchImages, ReadExternalMaps,
// CheckCameras, RequireUnrefined, RequireNoForeignMaps, ReadSparseModel and
// WorkspaceLock throw, and kMismatch where a map's shape is not that of its
// image, where depths are in other units than the sparse points or normals in
// another frame than said, or where an image has too few sparse points for
// scale_to_sparse.
//
// should_stop: if given, asked before each image. Once it returns true,
// kInterrupted is thrown; images that were imported stay so, and the same call
// begins anew.
ImportSummary ImportWorkspace(const ImportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop = {});

}  // namespace tsar
