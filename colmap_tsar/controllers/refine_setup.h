// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/controllers/image_pipeline.h"
#include "colmap_tsar/controllers/refine_devices.h"
#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/store/workspace.h"

#include <map>
#include <string>

namespace tsar {

// What runs over all images of a workspace and over a part of them share.

// With the type of maps that was asked for, or that there is.
Workspace OpenWorkspace(const WorkspaceRefineOptions& options);

// For the account of the run: what it was done with.
std::map<std::string, std::string> RuntimeText(
    const WorkspaceRefineOptions& options, const RefineDevices& devices);

// Throws the failure that came first, if there was one.
void RethrowFailure(const ImagePipeline& pipeline);
// Whether no image is left to be done.
bool IsComplete(const ImagePipeline& pipeline);
// For a run that the user stopped.
Error Interrupted(int num_done, int num_images);

}  // namespace tsar
