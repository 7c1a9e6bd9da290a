// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/world_plane.h"

#include <array>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// What is free of planes that are adjusted together, as one vector of numbers
// that are 0 at first. A free plane turns about two orthogonal axes along it
// and moves along its normal. The normal of a plane in a Manhattan frame is a
// column of the frame's rotation or its opposite: the frame turns about the
// axes of the world, with all of its planes, each of which moves by itself.
class PlaneParameters {
 public:
  // Where a plane is turned about, and which way it may turn.
  struct Plane {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // On the plane.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    // Form a right-handed basis with the normal.
    Eigen::Vector3d axis_s = Eigen::Vector3d::UnitX();
    Eigen::Vector3d axis_t = Eigen::Vector3d::UnitY();
    int frame = -1;  // Or none; and the column of its rotation.
    int column = -1;
    double sign = 1.0;  // Of the normal against that column.
  };
  // A range of the vector.
  struct Block {
    int begin = 0;
    int size = 0;
  };
  // The coefficients (normal, offset) of a plane, and their derivatives by its
  // blocks, of which each uses the first columns.
  using Coefficients = Eigen::Vector4d;
  using Derivatives = std::array<Eigen::Matrix<double, 4, 3>, 2>;

  // frame and column: per plane, or -1 for a free one; a plane in a frame is
  // turned about its point to the nearest direction of its column.
  PlaneParameters(const std::vector<WorldPlane>& planes,
                  const std::vector<Eigen::Vector3d>& points,
                  const std::vector<int>& frame,
                  const std::vector<int>& column,
                  const std::vector<Eigen::Matrix3d>& frames);

  int NumPlanes() const { return static_cast<int>(planes_.size()); }
  int NumFrames() const { return static_cast<int>(frames_.size()); }
  // Of the vector.
  int Size() const { return size_; }
  const Plane& At(int plane) const { return planes_[plane]; }
  const std::vector<Eigen::Matrix3d>& Frames() const { return frames_; }
  WorldPlane ToWorldPlane(int plane) const;

  // Of a plane: one, or that of its frame and then its own.
  int NumBlocks(int plane) const { return planes_[plane].frame < 0 ? 1 : 2; }
  Block BlockOf(int plane, int number) const;
  // The numbers that only this plane has.
  Block OwnBlock(int plane) const;
  Block FrameBlock(int frame) const { return {3 * frame, 3}; }

  // At these numbers, a pointer for each block. derivatives may be null.
  Coefficients Evaluate(int plane,
                        const double* const* blocks,
                        Derivatives* derivatives) const;

  // The same planes at these numbers, which are 0 from then on. points: where
  // the planes are turned about from then on, projected onto them.
  PlaneParameters MovedBy(const std::vector<double>& values,
                          const std::vector<Eigen::Vector3d>& points) const;

 private:
  std::vector<Plane> planes_;
  std::vector<int> begins_;  // Of the planes' own blocks.
  std::vector<Eigen::Matrix3d> frames_;
  int size_ = 0;
};

}  // namespace tsar
