// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// The manifest of one run over a workspace: stereo/tsar/manifest.json.
struct Manifest {
  std::string version;
  std::string type;
  std::map<std::string, std::string> options;
  // The runtime settings of the run; no result depends on them. Includes the
  // numbers of images with a mask and with a depth prior, if given.
  std::map<std::string, std::string> runtime;
  // The inputs of the run, see InputFingerprints.
  std::map<std::string, std::string> inputs;
  // Sums over the images' records.
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;
  // In the order of Workspace::Problems(); of each record the image, the status
  // and what comes after the files.
  std::vector<ImageRecord> images;

  int NumImages(ImageStatus status) const;
};

// The manifest with the state of every image of the workspace, from the
// records: images with other options, or without a record, are pending.
Manifest BuildManifest(const Workspace& workspace,
                       const RefineOptions& options,
                       std::map<std::string, std::string> inputs);

// The version and the inputs of the manifest in a workspace; an empty manifest
// where there is none.
Manifest ReadManifestInputs(const Workspace& workspace);

// Writes the manifest atomically.
void WriteManifest(const Workspace& workspace, const Manifest& manifest);

}  // namespace tsar
