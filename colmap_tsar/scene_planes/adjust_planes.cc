// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_planes.h"

#include "colmap_tsar/scene_planes/check_adjustment.h"
#include "colmap_tsar/scene_planes/local_unit.h"
#include "colmap_tsar/scene_planes/plane_parameters.h"
#include "colmap_tsar/scene_planes/plane_residuals.h"
#include "colmap_tsar/scene_planes/selected_inverse.h"
#include "colmap_tsar/scene_planes/solve_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// Radians, and shares of the scene's size: what moves by less stands still.
constexpr double kStandstill = 1e-9;
// In these units; without any evidence variances are far larger.
constexpr double kUnknownVariance = 0.25;

// The same in local lengths. Lists of measurements are long: they are taken one
// at a time.
PlaneAdjustment ToLocal(PlaneAdjustment adjustment, const LocalUnit& unit) {
  for (WorldPlane& plane : adjustment.planes) {
    plane = unit.ToLocal(plane);
  }
  for (PointOnPlane& point : adjustment.points) {
    point.point = unit.ToLocal(point.point);
    point.sigma /= unit.size;
  }
  for (PlaneCrease& crease : adjustment.creases) {
    crease.center = unit.ToLocal(crease.center);
  }
  return adjustment;
}

double LossWeight(double residual, double loss_scale) {
  return 1.0 / (1.0 + std::pow(residual / loss_scale, 2));
}

// Inverse depth of a plane; not finite where it passes through the centre.
double InverseDepth(const WorldPlane& plane,
                    const Eigen::Vector3d& center,
                    const Eigen::Vector3d& ray) {
  return -plane.normal.dot(ray) / plane.Height(center);
}

// Where what is known of each plane is known best: about there its errors of
// direction and of place are nearly independent.
std::vector<Eigen::Vector3d> Middles(
    const PlaneAdjustment& local,
    const std::vector<PlaneMeasurement>& measurements,
    const LocalUnit& unit,
    double loss_scale) {
  const size_t num_planes = local.planes.size();
  std::vector<Eigen::Vector3d> sums(num_planes, Eigen::Vector3d::Zero());
  std::vector<double> weights(num_planes, 0.0);
  const auto add = [&](int p, const Eigen::Vector3d& point, double weight) {
    sums[p] += weight * point;
    weights[p] += weight;
  };
  for (const PlaneMeasurement& measurement : measurements) {
    add(measurement.plane,
        unit.ToLocal(measurement.foot),
        measurement.information * unit.size * unit.size);
  }
  for (const PointOnPlane& point : local.points) {
    const double height = local.planes[point.plane].Height(point.point);
    add(point.plane,
        point.point,
        LossWeight(height / point.sigma, loss_scale) /
            (point.sigma * point.sigma));
  }
  const std::vector<double> measured = weights;
  for (const PlaneCrease& crease : local.creases) {
    for (const int p : {crease.first, crease.second}) {
      for (const Eigen::Vector3d& ray : crease.rays) {
        const Eigen::Vector3d step =
            ray / InverseDepth(local.planes[p], crease.center, ray);
        if (!(measured[p] > 0.0) && step.norm() < 1e6) {
          add(p, crease.center + step, 1.0);
        }
      }
    }
  }
  for (size_t p = 0; p < num_planes; ++p) {
    sums[p] = weights[p] > 0.0 ? Eigen::Vector3d(sums[p] / weights[p])
                               : Eigen::Vector3d::Zero();
  }
  return sums;
}

PlaneResiduals Residuals(const PlaneAdjustment& local,
                         const std::vector<PlaneMeasurement>& measurements,
                         const LocalUnit& unit) {
  PlaneResiduals residuals;
  for (const PlaneMeasurement& measurement : measurements) {
    if (measurement.information > 0.0) {
      residuals.push_back(
          std::make_unique<MeasurementResidual>(unit.ToLocal(measurement)));
    }
  }
  for (const PointOnPlane& point : local.points) {
    residuals.push_back(
        std::make_unique<PointResidual>(point.plane, point.point, point.sigma));
  }
  for (const PlaneCrease& crease : local.creases) {
    double inverse_depth = 0.0;
    for (const int p : {crease.first, crease.second}) {
      for (const Eigen::Vector3d& ray : crease.rays) {
        inverse_depth +=
            0.25 * std::abs(InverseDepth(local.planes[p], crease.center, ray));
      }
    }
    // Planes seen from their edge have no depth there.
    if (std::isfinite(inverse_depth) && inverse_depth > 0.0) {
      residuals.push_back(std::make_unique<CreaseResidual>(
          crease.first,
          crease.second,
          crease.center,
          crease.rays,
          crease.relative_sigma * inverse_depth));
    }
  }
  for (const PlaneAnglePrior& angle : local.angles) {
    if (angle.kind == PlaneAnglePrior::Kind::kOrthogonal) {
      residuals.push_back(std::make_unique<OrthogonalResidual>(
          angle.first, angle.second, angle.sigma));
    } else {
      const double cosine = local.planes[angle.first].normal.dot(
          local.planes[angle.second].normal);
      residuals.push_back(std::make_unique<ParallelResidual>(
          angle.first, angle.second, cosine < 0.0 ? -1.0 : 1.0, angle.sigma));
    }
  }
  return residuals;
}

PlaneParameters Parameters(const PlaneAdjustment& local,
                           const std::vector<Eigen::Vector3d>& middles) {
  std::vector<int> frame(local.planes.size(), -1);
  std::vector<int> column(local.planes.size(), -1);
  for (size_t p = 0; p < local.axes.size(); ++p) {
    frame[p] = local.axes[p].frame;
    column[p] = local.axes[p].column;
  }
  return {local.planes, middles, frame, column, local.frames};
}

// Of the turns about a plane's two axes and of its shift.
Eigen::Matrix3d LocalCovariance(const Eigen::SparseMatrix<double>& inverse,
                                const PlaneParameters& parameters,
                                int p) {
  const PlaneParameters::Plane& at = parameters.At(p);
  const int own = parameters.OwnBlock(p).begin;
  if (at.frame < 0) {
    return Eigen::Matrix3d(inverse.block(own, own, 3, 3));
  }
  const int turn = parameters.FrameBlock(at.frame).begin;
  Eigen::Matrix4d covariance;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      covariance(i, k) =
          inverse.coeff(i < 3 ? turn + i : own, k < 3 ? turn + k : own);
    }
  }
  Eigen::Matrix<double, 3, 4> by_turn_and_shift;
  by_turn_and_shift.setZero();
  by_turn_and_shift.row(0).head<3>() = at.axis_s;
  by_turn_and_shift.row(1).head<3>() = at.axis_t;
  by_turn_and_shift(2, 3) = 1.0;
  return by_turn_and_shift * covariance * by_turn_and_shift.transpose();
}

// Whether anything is known of the plane beside where it was.
bool SetCovariance(const PlaneParameters::Plane& at,
                   const Eigen::Matrix3d& local,
                   double size,
                   AdjustedPlane* plane) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      local.topLeftCorner<2, 2>());
  Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
  basis.topLeftCorner<2, 2>() = solver.eigenvectors();
  if (basis.determinant() < 0.0) {
    basis.col(1) = -basis.col(1);
  }
  plane->axis_s = basis(0, 0) * at.axis_s + basis(1, 0) * at.axis_t;
  plane->axis_t = basis(0, 1) * at.axis_s + basis(1, 1) * at.axis_t;
  const Eigen::Vector3d units(1.0, 1.0, size);
  const Eigen::Matrix3d principal = basis.transpose() * local * basis;
  plane->covariance = units.asDiagonal() * principal * units.asDiagonal();
  bool is_known = false;
  for (int i = 0; i < 3; ++i) {
    if (principal(i, i) < kUnknownVariance) {
      is_known = true;
    } else {
      plane->covariance.row(i).setZero();
      plane->covariance.col(i).setZero();
      plane->covariance(i, i) = std::numeric_limits<double>::infinity();
    }
  }
  return is_known;
}

}  // namespace

AdjustedPlanes AdjustPlanes(const PlaneAdjustment& adjustment,
                            const MeasurePlanes& measure,
                            const AdjustPlanesOptions& options) {
  CheckAdjustment(adjustment, options);
  const int num_planes = static_cast<int>(adjustment.planes.size());
  AdjustedPlanes result;
  std::vector<WorldPlane> planes = adjustment.planes;
  std::vector<PlaneMeasurement> measurements;
  LocalUnit unit;
  PlaneAdjustment local;
  std::vector<Eigen::Vector3d> middles;
  bool stands_still = false;
  while (!stands_still && result.num_rounds < options.max_rounds) {
    measurements = measure(planes);
    CheckMeasurements(measurements, num_planes);
    if (result.num_rounds == 0) {
      unit = LocalUnitOf(adjustment, measurements);
      local = ToLocal(adjustment, unit);
    }
    middles = Middles(local, measurements, unit, options.loss_scale);
    const PlaneParameters parameters = Parameters(local, middles);
    const std::vector<double> values = SolvePlanes(
        parameters, Residuals(local, measurements, unit), options.loss_scale);
    const PlaneParameters moved = parameters.MovedBy(values, middles);
    stands_still = std::all_of(values.begin(), values.end(), [](double value) {
      return std::abs(value) < kStandstill;
    });
    for (int p = 0; p < num_planes; ++p) {
      local.planes[p] = moved.ToWorldPlane(p);
      planes[p] = unit.ToWorld(local.planes[p]);
    }
    local.frames = moved.Frames();
    ++result.num_rounds;
  }

  const PlaneParameters parameters = Parameters(local, middles);
  const Eigen::SparseMatrix<double> inverse = SelectedInverse(PlaneInformation(
      parameters, Residuals(local, measurements, unit), options.loss_scale));
  for (int p = 0; p < num_planes; ++p) {
    const PlaneParameters::Plane& at = parameters.At(p);
    AdjustedPlane plane;
    plane.plane = planes[p];
    plane.center = unit.ToWorld(at.point);
    const bool is_known = SetCovariance(
        at, LocalCovariance(inverse, parameters, p), unit.size, &plane);
    if (!is_known && at.frame < 0) {
      plane.plane = adjustment.planes[p];
    }
    result.planes.push_back(plane);
  }
  result.frames = local.frames;
  return result;
}

}  // namespace tsar
