// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/view_loader.h"
#include "colmap_tsar/view/refined_maps.h"

#include <string>

namespace tsar {

// Writes the results of images, given by their indices in the sparse model, and
// their records. Can be used from several threads for different images.
class ResultWriter {
 public:
  // All references must outlive this object. loader: reads the views while
  // results are written. options_hash, planes: see RefinePlan; those that the
  // results are made with.
  ResultWriter(const Workspace& workspace,
               InputFingerprints& inputs,
               ViewLoader& loader,
               std::string options_hash,
               std::string planes);

  // Replaces the maps by the refined ones, without masked pixels, and records
  // the counts and times of the report.
  void Write(int image, RefinedMaps maps, ImageReport* report);
  // Keeps the original maps, and records the reason.
  void Keep(int image, const std::string& reason, ImageReport* report);

 private:
  const Workspace& workspace_;
  InputFingerprints& inputs_;
  ViewLoader& loader_;
  const std::string options_hash_;
  const std::string planes_;
};

}  // namespace tsar
