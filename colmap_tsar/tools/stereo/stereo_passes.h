// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <optional>

namespace tsar {

// The files that one pass makes of one image.
struct StereoMapFiles {
  ContainedPath depth;
  ContainedPath normal;
  std::optional<ContainedPath> cost;  // Some passes have none.

  bool Exist() const;
};

// Writes each file atomically, the depth map last; creates the folders.
void WriteStereoMaps(const StereoMapFiles& files, const StereoMaps& maps);

// Reads the view's maps and, if with_cost, its costs, which files must then
// name.
void ReadStereoMaps(const StereoMapFiles& files,
                    bool with_costs,
                    ViewData* view);

// The passes over all images: the photometric one (index 0), the geometric
// ones, and the one that matches under the planar prior.
class StereoPasses {
 public:
  // workspace must outlive this object.
  StereoPasses(const Workspace& workspace, const StereoOptions& options);

  int NumPasses() const { return 1 + num_geometric_ + num_prior_; }
  bool IsUnderPrior(int pass) const { return pass > num_geometric_; }
  // Whether the pass fills the maps that the next one matches under the prior.
  bool Fills(int pass) const {
    return num_prior_ > 0 && pass == num_geometric_;
  }
  StereoMapFiles Files(int pass, int image) const;
  // Whether the image has all final maps of the run.
  bool IsDone(int image) const;
  // Removes the intermediate files after the last pass.
  void RemoveFilesBetween() const;

 private:
  const Workspace& workspace_;
  const int num_geometric_;
  const int num_prior_;
};

}  // namespace tsar
