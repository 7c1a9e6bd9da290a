// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/scene_model_file.h"

#include <filesystem>

namespace tsar {

// What provenance maps call interpolated is on columns and pipes what their
// outlines determine, which says nothing of interpolated depths. Error
// kMismatch for the model of a workspace that has such.
inline void RequireNoCylinders(const SceneModel& model,
                               const std::filesystem::path& root) {
  if (!model.cylinders.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      GetSceneModelPath(root).string(),
                      "this scene has columns or pipes, whose depths would "
                      "count as interpolated ones",
                      "refine it with --TsarRefine.experiment cylinders=0");
  }
}

}  // namespace tsar
