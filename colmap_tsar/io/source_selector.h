// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Selects the source images of a reference, which must confirm its depths
// independently. Images from one viewpoint agree at any depth: a viewpoint is
// independent of the reference's if the 75th percentile of the triangulation
// angles of sparse points reaches a minimum, and of another source's if it
// reaches 0.2 degrees, about the parallax within which views agree.
class SourceSelector {
 public:
  // The model must outlive the selector.
  SourceSelector(const SparseModel& model,
                 double min_triangulation_angle_degrees);

  // Selects sources as COLMAP's `__auto__` does: those that share most sparse
  // points with the reference, among the images whose triangulation angles of
  // shared points reach the minimum; here they are independent of the sources
  // selected before as well. COLMAP leaves the order of equal counts open; here
  // the lower index goes first.
  //
  // Time: the reference's observations times the length of their tracks, and
  // once through the observations of each image that is considered.
  std::vector<int> SelectSources(int reference, int max_num_sources) const;

  // The given images whose viewpoints are independent of the reference's and of
  // each one selected before. All of them if the reference sees no sparse
  // point.
  std::vector<int> SelectIndependent(int reference,
                                     const std::vector<int>& images) const;

  // Whether some other image shares a sparse point with the reference.
  bool HasOverlap(int reference) const;

 private:
  // The number of points of a reference that are sampled.
  static constexpr size_t kMaxNumPoints = 64;

  // The images that see a point, one per observation.
  std::span<const int> TrackOf(int point) const;
  // A sample of the points that the reference sees.
  std::vector<Eigen::Vector3d> PointsOf(int reference) const;
  // Whether the percentile of the triangulation angles of these points reaches
  // the angle of this tangent.
  bool ReachAngle(const std::vector<Eigen::Vector3d>& points,
                  int image_a,
                  int image_b,
                  double min_tangent) const;
  bool IsIndependent(const std::vector<Eigen::Vector3d>& points,
                     int image,
                     const std::vector<int>& sources) const;
  bool HasTriangulationAngle(int reference, int source) const;

  const SparseModel& model_;
  const double min_tangent_;
  std::vector<Eigen::Vector3d> centers_;
  // Point i is seen by track_images_[track_begins_[i] ... track_begins_[i +
  // 1]).
  std::vector<size_t> track_begins_;
  std::vector<int> track_images_;
};

}  // namespace tsar
