// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/fit_plane.h"

#include "colmap_tsar/base/avx2.h"
#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
// A spread about the mean that is a smaller share of that about the origin is
// nothing but rounding errors.
constexpr double kMinPreciseShare = 1e-12;

// Sums over all samples in one step of a fit. Positions are those of the feet:
// residuals are measured along the ray, and rotating the plane about the ray's
// foot instead of the measured point includes the derivative of the slope with
// respect to the normal.
struct Sums {
  double weights = 0.0;
  // About the mean, along two tangents of the plane.
  double xx = 0.0, xy = 0.0, yy = 0.0;
  double xh = 0.0, yh = 0.0;  // Products with the heights over the plane.
  // Weighted means, which are NaN if all weights are 0.
  double height = 0.0;
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();
};

// The axes of a plane: x and y along two tangents, z along the normal, from an
// origin amid the samples, so that sums of products stay precise.
struct PlaneAxes {
  Eigen::Vector3d x;
  Eigen::Vector3d y;
  Eigen::Vector3d z;
  Eigen::Vector3d origin;

  PlaneAxes(const WorldPlane& plane, const Eigen::Vector3d& around)
      : x(plane.normal.unitOrthogonal()),
        y(plane.normal.cross(x)),
        z(plane.normal),
        origin(around) {}
};

// Sums of products of a weight with 1, the height, and the foot's coordinates,
// each for one lane of all blocks.
constexpr int kLanes = FitSamples::Block::kSize;
struct LaneSums {
  enum { kW, kH, kX, kY, kZ, kXX, kXY, kYY, kXH, kYH, kCount };
  double of[kCount][kLanes] = {};

  double operator[](int sum) const {
    return std::accumulate(of[sum], of[sum] + kLanes, 0.0);
  }
};

LaneSums AddUpLanes(const FitSamples& samples,
                    const WorldPlane& plane,
                    const PlaneAxes& axes,
                    double loss_scale) {
  LaneSums sums;
  const double a = plane.normal.x();
  const double b = plane.normal.y();
  const double c = plane.normal.z();
  for (const FitSamples::Block& block : samples.Blocks()) {
    for (int i = 0; i < kLanes; ++i) {
      const double along =
          a * block.ray_x[i] + b * block.ray_y[i] + c * block.ray_z[i];
      const double slope = std::max(std::abs(along), block.min_slope[i]);
      const double height =
          a * block.x[i] + b * block.y[i] + c * block.z[i] + plane.offset;
      // w / error^2 times Cauchy's weight, 1 / (1 + (height / scale)^2).
      const double scale = block.sigma[i] * slope * loss_scale;
      const double weight = block.weight[i] * loss_scale * loss_scale /
                            (scale * scale + height * height);
      const double step = (along > 0.0 ? -height : height) / slope;
      const double foot_x =
          block.x[i] + step * block.ray_x[i] - axes.origin.x();
      const double foot_y =
          block.y[i] + step * block.ray_y[i] - axes.origin.y();
      const double foot_z =
          block.z[i] + step * block.ray_z[i] - axes.origin.z();
      const auto along_axis = [&](const Eigen::Vector3d& axis) {
        return axis.x() * foot_x + axis.y() * foot_y + axis.z() * foot_z;
      };
      const double x = along_axis(axes.x);
      const double y = along_axis(axes.y);
      const double weighted_x = weight * x;
      const double weighted_y = weight * y;
      sums.of[LaneSums::kW][i] += weight;
      sums.of[LaneSums::kH][i] += weight * height;
      sums.of[LaneSums::kX][i] += weighted_x;
      sums.of[LaneSums::kY][i] += weighted_y;
      sums.of[LaneSums::kZ][i] += weight * along_axis(axes.z);
      sums.of[LaneSums::kXX][i] += weighted_x * x;
      sums.of[LaneSums::kXY][i] += weighted_x * y;
      sums.of[LaneSums::kYY][i] += weighted_y * y;
      sums.of[LaneSums::kXH][i] += weighted_x * height;
      sums.of[LaneSums::kYH][i] += weighted_y * height;
    }
  }
  return sums;
}

TSAR_FOR_AVX2 LaneSums AddUpLanesForAvx2(const FitSamples& samples,
                                         const WorldPlane& plane,
                                         const PlaneAxes& axes,
                                         double loss_scale) {
  return AddUpLanes(samples, plane, axes, loss_scale);
}

Sums AddUp(const FitSamples& samples,
           const WorldPlane& plane,
           const PlaneAxes& axes,
           double loss_scale) {
  const LaneSums lanes = (HasAvx2() ? AddUpLanesForAvx2 : AddUpLanes)(
      samples, plane, axes, loss_scale);
  Sums sums;
  sums.weights = lanes[LaneSums::kW];
  sums.height = lanes[LaneSums::kH] / sums.weights;
  const double x = lanes[LaneSums::kX] / sums.weights;
  const double y = lanes[LaneSums::kY] / sums.weights;
  const double z = lanes[LaneSums::kZ] / sums.weights;
  sums.foot = axes.origin + x * axes.x + y * axes.y + z * axes.z;
  sums.xx = lanes[LaneSums::kXX] - x * lanes[LaneSums::kX];
  sums.xy = lanes[LaneSums::kXY] - x * lanes[LaneSums::kY];
  sums.yy = lanes[LaneSums::kYY] - y * lanes[LaneSums::kY];
  sums.xh = lanes[LaneSums::kXH] - x * lanes[LaneSums::kH];
  sums.yh = lanes[LaneSums::kYH] - y * lanes[LaneSums::kH];
  const double around_origin = lanes[LaneSums::kXX] + lanes[LaneSums::kYY];
  if (!(sums.xx + sums.yy > kMinPreciseShare * around_origin)) {
    sums.xx = sums.xy = sums.yy = sums.xh = sums.yh = 0.0;
  }
  return sums;
}

// Whether the squared length of a step, in standard errors, is negligible; also
// of a step that is no number.
bool IsNegligible(double square) {
  return !(square > kNegligibleStep * kNegligibleStep);
}

struct FitStep {
  WorldPlane plane;     // After the step.
  double square = 0.0;  // The squared length of the step, in standard errors.
  Eigen::Vector3d middle;  // The mean of the feet.
};

// One Gauss-Newton step that reduces the loss of the normalized residuals.
// Returns nullopt if the observations do not determine a plane.
std::optional<FitStep> StepToFit(const WorldPlane& plane,
                                 const FitSamples& samples,
                                 const Eigen::Vector3d& around,
                                 double loss_scale) {
  const PlaneAxes axes(plane, around);
  const Sums sums = AddUp(samples, plane, axes, loss_scale);
  const double determinant = sums.xx * sums.yy - sums.xy * sums.xy;
  const double trace = sums.xx + sums.yy;
  // The negated comparison also holds for NaN.
  if (!(determinant > kMinSquareRatio * trace * trace)) {
    return std::nullopt;
  }
  const double turn_x = (sums.xy * sums.yh - sums.yy * sums.xh) / determinant;
  const double turn_y = (sums.xy * sums.xh - sums.xx * sums.yh) / determinant;
  const Eigen::Vector3d turn = turn_x * axes.x + turn_y * axes.y;
  const Eigen::Vector3d normal = plane.normal + turn;
  const double offset = plane.offset - turn.dot(sums.foot) - sums.height;
  const double length = normal.norm();
  return FitStep{{normal / length, offset / length},
                 sums.weights * sums.height * sums.height +
                     turn_x * (turn_x * sums.xx + 2.0 * turn_y * sums.xy) +
                     turn_y * turn_y * sums.yy,
                 sums.foot};
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

TurnTerms FindTurnTerms(const JointPlane& joint,
                        const Eigen::Vector3d& around,
                        double loss_scale) {
  const WorldPlane& plane = joint.plane;
  const PlaneAxes axes(plane, around);
  const Sums sums = AddUp(*joint.samples, plane, axes, loss_scale);
  TurnTerms result;
  if (!(sums.weights > 0.0)) {
    result.middle = -plane.offset * plane.normal;
    return result;
  }
  result.middle = sums.foot + sums.height * plane.normal;
  result.square_of_move = sums.weights * sums.height * sums.height;
  // normal x position, for positions along x and along y.
  const Eigen::Vector3d& of_x = axes.y;
  const Eigen::Vector3d of_y = -axes.x;
  const Eigen::Matrix3d mixed = of_x * of_y.transpose();
  result.products = sums.xx * of_x * of_x.transpose() +
                    sums.xy * (mixed + mixed.transpose()) +
                    sums.yy * of_y * of_y.transpose();
  result.heights = sums.xh * of_x + sums.yh * of_y;
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

// around: a point amid the samples of each plane.
JointStep StepTogether(const std::optional<Eigen::Vector3d>& axis,
                       const std::vector<Eigen::Vector3d>& around,
                       double loss_scale,
                       std::vector<JointPlane>* planes) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d heights = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> middles;
  double square = 0.0;
  for (size_t p = 0; p < planes->size(); ++p) {
    const TurnTerms terms = FindTurnTerms((*planes)[p], around[p], loss_scale);
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

Eigen::Vector3d FitSamples::First() const {
  if (size_ == 0) {
    return Eigen::Vector3d::Zero();
  }
  return {blocks_[0].x[0], blocks_[0].y[0], blocks_[0].z[0]};
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
  Eigen::Vector3d middle = samples.First();
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<FitStep> step =
        StepToFit(plane, samples, middle, loss_scale);
    if (!step) {
      return initial;
    }
    plane = step->plane;
    middle = step->middle;
    if (IsNegligible(step->square)) {
      break;
    }
  }
  return plane;
}

Eigen::Matrix3d FitTogether(const std::optional<Eigen::Vector3d>& axis,
                            double loss_scale,
                            std::vector<JointPlane>* planes) {
  std::vector<Eigen::Vector3d> around;
  for (const JointPlane& joint : *planes) {
    around.push_back(joint.samples->Middle());
  }
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int i = 0; i < kMaxSteps; ++i) {
    const JointStep step = StepTogether(axis, around, loss_scale, planes);
    rotation = step.rotation * rotation;
    if (IsNegligible(step.square)) {
      break;
    }
  }
  return rotation;
}

}  // namespace tsar
