// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/plane_parameters.h"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// The matrix that multiplies as the cross product with v from the left.
Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

struct Rotation {
  Eigen::Matrix3d matrix;
  // A small change w of the rotation vector turns the result by J w.
  Eigen::Matrix3d left_jacobian;
};

// By Rodrigues' formula: a turn about the vector by its length in radians.
Rotation RotationOf(const Eigen::Vector3d& vector) {
  const double square = vector.squaredNorm();
  const double angle = std::sqrt(square);
  double sine = 1.0 - square / 6.0;           // sin(x) / x
  double cosine = 0.5 - square / 24.0;        // (1 - cos(x)) / x^2
  double cubic = 1.0 / 6.0 - square / 120.0;  // (x - sin(x)) / x^3
  if (angle > 1e-3) {
    sine = std::sin(angle) / angle;
    cosine = (1.0 - std::cos(angle)) / square;
    cubic = (1.0 - sine) / square;
  }
  const Eigen::Matrix3d cross = Cross(vector);
  const Eigen::Matrix3d square_cross = cross * cross;
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  return {one + sine * cross + cosine * square_cross,
          one + cosine * cross + cubic * square_cross};
}

Eigen::Matrix3d Orthonormal(const Eigen::Matrix3d& rotation) {
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

}  // namespace

PlaneParameters::PlaneParameters(const std::vector<WorldPlane>& planes,
                                 const std::vector<Eigen::Vector3d>& points,
                                 const std::vector<int>& frame,
                                 const std::vector<int>& column,
                                 const std::vector<Eigen::Matrix3d>& frames)
    : frames_(frames) {
  size_ = 3 * NumFrames();
  for (size_t p = 0; p < planes.size(); ++p) {
    const double height = planes[p].Height(points[p]);
    Plane plane;
    plane.point = points[p] - height * planes[p].normal;
    plane.normal = planes[p].normal;
    if (frame[p] >= 0) {
      plane.frame = frame[p];
      plane.column = column[p];
      const Eigen::Vector3d direction = frames_[frame[p]].col(column[p]);
      plane.sign = direction.dot(plane.normal) < 0.0 ? -1.0 : 1.0;
      plane.normal = plane.sign * direction;
    }
    plane.axis_s = plane.normal.unitOrthogonal();
    plane.axis_t = plane.normal.cross(plane.axis_s);
    planes_.push_back(plane);
    begins_.push_back(size_);
    size_ += plane.frame < 0 ? 3 : 1;
  }
}

WorldPlane PlaneParameters::ToWorldPlane(int plane) const {
  const Plane& at = planes_[plane];
  return {at.normal, -at.normal.dot(at.point)};
}

PlaneParameters::Block PlaneParameters::OwnBlock(int plane) const {
  return {begins_[plane], planes_[plane].frame < 0 ? 3 : 1};
}

PlaneParameters::Block PlaneParameters::BlockOf(int plane, int number) const {
  return planes_[plane].frame >= 0 && number == 0
             ? FrameBlock(planes_[plane].frame)
             : OwnBlock(plane);
}

PlaneParameters::Coefficients PlaneParameters::Evaluate(
    int plane, const double* const* blocks, Derivatives* derivatives) const {
  const Plane& at = planes_[plane];
  Eigen::Vector3d vector;
  double shift = 0.0;
  if (at.frame < 0) {
    vector = blocks[0][0] * at.axis_s + blocks[0][1] * at.axis_t;
    shift = blocks[0][2];
  } else {
    vector << blocks[0][0], blocks[0][1], blocks[0][2];
    shift = blocks[1][0];
  }
  const Rotation rotation = RotationOf(vector);
  Coefficients coefficients;
  coefficients.head<3>() = rotation.matrix * at.normal;
  coefficients[3] = -coefficients.head<3>().dot(at.point) - shift;
  if (derivatives != nullptr) {
    const Eigen::Matrix3d normal_by_vector =
        -Cross(coefficients.head<3>()) * rotation.left_jacobian;
    Eigen::Matrix<double, 4, 3> by_vector;
    by_vector.topRows<3>() = normal_by_vector;
    by_vector.row(3) = -at.point.transpose() * normal_by_vector;
    const Eigen::Vector4d by_shift = -Eigen::Vector4d::UnitW();
    if (at.frame < 0) {
      (*derivatives)[0].col(0) = by_vector * at.axis_s;
      (*derivatives)[0].col(1) = by_vector * at.axis_t;
      (*derivatives)[0].col(2) = by_shift;
    } else {
      (*derivatives)[0] = by_vector;
      (*derivatives)[1].col(0) = by_shift;
    }
  }
  return coefficients;
}

PlaneParameters PlaneParameters::MovedBy(
    const std::vector<double>& values,
    const std::vector<Eigen::Vector3d>& points) const {
  std::vector<Eigen::Matrix3d> frames;
  for (int f = 0; f < NumFrames(); ++f) {
    const Eigen::Vector3d vector(
        values[3 * f], values[3 * f + 1], values[3 * f + 2]);
    frames.push_back(vector.isZero(0.0)
                         ? frames_[f]
                         : Orthonormal(RotationOf(vector).matrix * frames_[f]));
  }
  std::vector<WorldPlane> planes;
  std::vector<int> frame;
  std::vector<int> column;
  for (int p = 0; p < NumPlanes(); ++p) {
    const double* blocks[2] = {};
    for (int i = 0; i < NumBlocks(p); ++i) {
      blocks[i] = values.data() + BlockOf(p, i).begin;
    }
    const Coefficients moved = Evaluate(p, blocks, nullptr);
    const double norm = moved.head<3>().norm();
    planes.push_back({moved.head<3>() / norm, moved[3] / norm});
    frame.push_back(planes_[p].frame);
    column.push_back(planes_[p].column);
  }
  return {planes, points, frame, column, frames};
}

}  // namespace tsar
