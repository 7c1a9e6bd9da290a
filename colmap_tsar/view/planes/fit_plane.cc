// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/fit_plane.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace tsar {
namespace {

// Fits end when a step is shorter than this share of the standard error of what
// is fitted, so that the result does not depend on the path to it.
constexpr double kNegligibleStep = 1e-6;
constexpr int kMaxSteps = 100;
// A support whose width is below this share of its length is a line, about
// which a plane could turn.
constexpr double kMinRelativeWidth = 0.01;
// The ratio kMinRelativeWidth of sums of squares.
constexpr double kMinSquareRatio = kMinRelativeWidth * kMinRelativeWidth;

// The terms of a block in one step of a fit.
struct TermBlock {
  static constexpr int kSize = FitSamples::Block::kSize;
  double weight[kSize];
  double height[kSize];  // Height over the plane.
  // Residuals are measured along the ray. The derivative of the slope with
  // respect to the normal is included by rotating the plane about the ray's
  // foot instead of the measured point.
  double foot_x[kSize];
  double foot_y[kSize];
  double foot_z[kSize];

  TermBlock(const FitSamples::Block& block,
            const WorldPlane& plane,
            double loss_scale) {
    const double a = plane.normal.x();
    const double b = plane.normal.y();
    const double c = plane.normal.z();
    for (int i = 0; i < kSize; ++i) {
      const double along =
          a * block.ray_x[i] + b * block.ray_y[i] + c * block.ray_z[i];
      const double slope = std::max(std::abs(along), block.min_slope[i]);
      height[i] =
          a * block.x[i] + b * block.y[i] + c * block.z[i] + plane.offset;
      const double error = block.sigma[i] * slope;
      const double ratio = height[i] / (error * loss_scale);
      weight[i] = block.weight[i] / (error * error * (1.0 + ratio * ratio));
      const double step = (along > 0.0 ? -height[i] : height[i]) / slope;
      foot_x[i] = block.x[i] + step * block.ray_x[i];
      foot_y[i] = block.y[i] + step * block.ray_y[i];
      foot_z[i] = block.z[i] + step * block.ray_z[i];
    }
  }

  Eigen::Vector3d Foot(int i) const {
    return {foot_x[i], foot_y[i], foot_z[i]};
  }
};

// The terms of all samples and their weighted means, which are NaN if all
// weights are 0.
struct Terms {
  std::vector<TermBlock> blocks;
  double weights = 0.0;
  double mean_height = 0.0;
  Eigen::Vector3d mean_foot = Eigen::Vector3d::Zero();

  Terms(const FitSamples& samples, const WorldPlane& plane, double loss_scale) {
    blocks.reserve(samples.Blocks().size());
    for (const FitSamples::Block& block : samples.Blocks()) {
      const TermBlock& term = blocks.emplace_back(block, plane, loss_scale);
      for (int i = 0; i < TermBlock::kSize; ++i) {
        weights += term.weight[i];
        mean_height += term.weight[i] * term.height[i];
        mean_foot += term.weight[i] * term.Foot(i);
      }
    }
    mean_height /= weights;
    mean_foot /= weights;
  }
};

// Whether the squared length of a step, in standard errors, is negligible; also
// of a step that is no number.
bool IsNegligible(double square) {
  return !(square > kNegligibleStep * kNegligibleStep);
}

struct FitStep {
  WorldPlane plane;     // After the step.
  double square = 0.0;  // The squared length of the step, in standard errors.
};

// One Gauss-Newton step that reduces the loss of the normalized residuals.
// Returns nullopt if the observations do not determine a plane.
std::optional<FitStep> StepToFit(const WorldPlane& plane,
                                 const FitSamples& samples,
                                 double loss_scale) {
  const Terms terms(samples, plane, loss_scale);
  const Eigen::Vector3d tangent = plane.normal.unitOrthogonal();
  const Eigen::Vector3d other_tangent = plane.normal.cross(tangent);
  double xx = 0.0, xy = 0.0, yy = 0.0, xh = 0.0, yh = 0.0;
  for (const TermBlock& term : terms.blocks) {
    for (int i = 0; i < TermBlock::kSize; ++i) {
      const double weight = term.weight[i];
      const Eigen::Vector3d position = term.Foot(i) - terms.mean_foot;
      const double x = tangent.dot(position);
      const double y = other_tangent.dot(position);
      const double height = term.height[i] - terms.mean_height;
      xx += weight * x * x;
      xy += weight * x * y;
      yy += weight * y * y;
      xh += weight * x * height;
      yh += weight * y * height;
    }
  }
  const double determinant = xx * yy - xy * xy;
  // The negated comparison also holds for NaN.
  if (!(determinant > kMinSquareRatio * (xx + yy) * (xx + yy))) {
    return std::nullopt;
  }
  const double turn_x = (xy * yh - yy * xh) / determinant;
  const double turn_y = (xy * xh - xx * yh) / determinant;
  const Eigen::Vector3d turn = turn_x * tangent + turn_y * other_tangent;
  const Eigen::Vector3d normal = plane.normal + turn;
  const double offset =
      plane.offset - turn.dot(terms.mean_foot) - terms.mean_height;
  const double length = normal.norm();
  return FitStep{{normal / length, offset / length},
                 terms.weights * terms.mean_height * terms.mean_height +
                     turn_x * (turn_x * xx + 2.0 * turn_y * xy) +
                     turn_y * turn_y * yy};
}

// The terms of one plane in a step of a joint fit. A small rotation w changes a
// point's height over the plane by w . (normal x position), where the position
// is that of the point's foot relative to the middle, about which the plane
// turns.
struct TurnTerms {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d heights = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // After the move.
  double square_of_move = 0.0;                       // In standard errors.
};

TurnTerms FindTurnTerms(const JointPlane& joint, double loss_scale) {
  const WorldPlane& plane = joint.plane;
  const Terms terms(*joint.samples, plane, loss_scale);
  TurnTerms result;
  if (!(terms.weights > 0.0)) {
    result.middle = -plane.offset * plane.normal;
    return result;
  }
  result.middle = terms.mean_foot + terms.mean_height * plane.normal;
  result.square_of_move = terms.weights * terms.mean_height * terms.mean_height;
  for (const TermBlock& term : terms.blocks) {
    for (int i = 0; i < TermBlock::kSize; ++i) {
      const Eigen::Vector3d lever =
          plane.normal.cross(term.Foot(i) - terms.mean_foot);
      result.products += term.weight[i] * lever * lever.transpose();
      result.heights +=
          term.weight[i] * (term.height[i] - terms.mean_height) * lever;
    }
  }
  return result;
}

// The rotation of least angle, about directions that the planes determine.
Eigen::Vector3d SolveTurn(const std::optional<Eigen::Vector3d>& axis,
                          const Eigen::Matrix3d& products,
                          const Eigen::Vector3d& heights) {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  if (axis) {
    const double product = axis->dot(products * *axis);
    if (product > kMinSquareRatio * products.trace()) {
      turn = -axis->dot(heights) / product * *axis;
    }
  } else {
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> solver;
    solver.setThreshold(kMinSquareRatio);
    turn = -solver.compute(products).solve(heights);
  }
  return turn.allFinite() ? turn : Eigen::Vector3d::Zero();
}

struct JointStep {
  Eigen::Matrix3d rotation;
  double square = 0.0;  // The squared length of the step, in standard errors.
};

JointStep StepTogether(const std::optional<Eigen::Vector3d>& axis,
                       double loss_scale,
                       std::vector<JointPlane>* planes) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d heights = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> middles;
  double square = 0.0;
  for (const JointPlane& joint : *planes) {
    const TurnTerms terms = FindTurnTerms(joint, loss_scale);
    products += terms.products;
    heights += terms.heights;
    middles.push_back(terms.middle);
    square += terms.square_of_move;
  }
  const Eigen::Vector3d turn = SolveTurn(axis, products, heights);
  square += turn.dot(products * turn);
  const double angle = turn.norm();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (angle > 0.0) {
    rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  for (size_t p = 0; p < planes->size(); ++p) {
    WorldPlane& plane = (*planes)[p].plane;
    plane.normal = (rotation * plane.normal).normalized();
    plane.offset = -plane.normal.dot(middles[p]);
  }
  return {rotation, square};
}

}  // namespace

void FitSamples::Add(const DepthObservation& observation) {
  constexpr int kSize = Block::kSize;
  const int lane = size_++ % kSize;
  if (lane == 0) {
    Block& block = blocks_.emplace_back();
    std::fill_n(block.min_slope, kSize, 1.0);
    std::fill_n(block.sigma, kSize, 1.0);
  }
  const Eigen::Vector3d point = observation.Point();
  Block& block = blocks_.back();
  block.x[lane] = point.x();
  block.y[lane] = point.y();
  block.z[lane] = point.z();
  block.ray_x[lane] = observation.ray.x();
  block.ray_y[lane] = observation.ray.y();
  block.ray_z[lane] = observation.ray.z();
  block.min_slope[lane] = RaySlope({Eigen::Vector3d::Zero(), 0.0}, observation);
  block.sigma[lane] = observation.sigma;
  block.weight[lane] = observation.weight;
}

Eigen::Vector3d FitSamples::Middle() const {
  if (size_ == 0) {
    return Eigen::Vector3d::Zero();
  }
  const auto median = [&](const double(Block::*coordinates)[Block::kSize]) {
    std::vector<double> values;
    for (int i = 0; i < size_; ++i) {
      const Block& block = blocks_[i / Block::kSize];
      values.push_back((block.*coordinates)[i % Block::kSize]);
    }
    return UpperMedian(&values);
  };
  return {median(&Block::x), median(&Block::y), median(&Block::z)};
}

WorldPlane FitPlane(const WorldPlane& initial,
                    const FitSamples& samples,
                    double loss_scale) {
  WorldPlane plane = initial;
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<FitStep> step = StepToFit(plane, samples, loss_scale);
    if (!step) {
      return initial;
    }
    plane = step->plane;
    if (IsNegligible(step->square)) {
      break;
    }
  }
  return plane;
}

Eigen::Matrix3d FitTogether(const std::optional<Eigen::Vector3d>& axis,
                            double loss_scale,
                            std::vector<JointPlane>* planes) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int i = 0; i < kMaxSteps; ++i) {
    const JointStep step = StepTogether(axis, loss_scale, planes);
    rotation = step.rotation * rotation;
    if (IsNegligible(step.square)) {
      break;
    }
  }
  return rotation;
}

}  // namespace tsar
