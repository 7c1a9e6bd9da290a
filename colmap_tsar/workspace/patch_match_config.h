// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/sparse_model.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// Chooses source images as COLMAP's `__auto__` does: those that share most
// sparse points with the reference, among the images whose 75th percentile of
// the triangulation angles over the shared points reaches a minimum. COLMAP
// leaves the order of equal counts open; here the lower index goes first.
//
// Time per reference: its observations times the length of their tracks, and
// once through the observations of each image that is considered.
class SourceSelector {
 public:
  // The model must outlive the selector.
  explicit SourceSelector(const SparseModel& model);

  std::vector<int> SelectSources(int reference,
                                 int max_num_sources,
                                 double min_triangulation_angle_degrees) const;

 private:
  bool HasTriangulationAngle(int reference,
                             int source,
                             double min_tangent) const;

  const SparseModel& model_;
  std::vector<Eigen::Vector3d> centers_;
  // Point i is seen by track_images_[track_begins_[i] ... track_begins_[i +
  // 1]).
  std::vector<size_t> track_begins_;
  std::vector<int> track_images_;
};

// One depth map to work on: indices into SparseModel::images.
struct StereoProblem {
  int reference = -1;
  // In the file's order, or by falling number of shared points; may be empty
  // where `__auto__` finds no image.
  std::vector<int> sources;
};

// Reads stereo/patch-match.cfg: pairs of lines, the reference image and its
// sources: `__all__`, `__auto__, N` (see SelectSources) or a list of names.
// Blank lines and lines that begin with '#' are skipped.
//
// Throws Error: kNotFound (no such file), kMismatch (an image that the sparse
// model does not hold), kCorrupt (a reference without sources, twice, or among
// its own sources; a bad N). Messages name the line.
std::vector<StereoProblem> ReadPatchMatchConfig(
    const std::filesystem::path& path,
    const SparseModel& model,
    double min_triangulation_angle_degrees = 1.0);

}  // namespace tsar
