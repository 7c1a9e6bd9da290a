// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/plane_residuals.h"

#include "colmap_tsar/scene_planes/plane_parameters.h"

#include <array>
#include <memory>
#include <vector>

#include "tests/scene_planes/adjust_planes_fixture.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kStep = 1e-6;

Vector4d Coefficients(const WorldPlane& plane) {
  return {plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset};
}

TEST(PlaneResiduals, DerivativesAreThoseOfTheResiduals) {
  const Vector3d center(0.1, 0.2, -0.3);
  const Patch patch = {{0.2, 0.1, 4.0}, {1.0, 0.0, 0.1}, {0.0, 0.8, -0.1}};
  std::vector<std::unique_ptr<PlaneResidual>> residuals;
  residuals.push_back(std::make_unique<MeasurementResidual>(
      MeasurePlane(0, patch.Plane(), ObservePatch(patch, center, 5))));
  residuals.push_back(
      std::make_unique<PointResidual>(0, Vector3d(0.5, -0.5, 4.2), 0.1));
  residuals.push_back(std::make_unique<CreaseResidual>(
      0,
      1,
      center,
      std::array<Vector3d, 2>{Vector3d(0.1, 0.1, 1.0),
                              Vector3d(-0.2, 0.1, 1.0)},
      0.01));
  residuals.push_back(std::make_unique<ParallelResidual>(0, 1, -1.0, 0.02));
  residuals.push_back(std::make_unique<OrthogonalResidual>(0, 1, 0.02));
  const Vector4d planes[2] = {
      Coefficients(Displaced(patch.Plane(), patch.middle, 3.0, 0.1)),
      Coefficients(PlaneThrough({-0.5, 0.9, 0.2}, {0.0, -1.0, 3.0}))};
  for (const auto& residual : residuals) {
    PlaneResidual::Vector values;
    PlaneResidual::Derivatives derivatives[2];
    ASSERT_TRUE(residual->Evaluate(planes, &values, derivatives));
    ASSERT_EQ(values.size(), residual->Size());
    EXPECT_GT(values.norm(), 1e-3);
    for (int p = 0; p < residual->NumPlanes(); ++p) {
      for (int i = 0; i < 4; ++i) {
        Vector4d moved[2] = {planes[0], planes[1]};
        PlaneResidual::Vector above;
        PlaneResidual::Vector below;
        moved[p][i] += kStep;
        ASSERT_TRUE(residual->Evaluate(moved, &above, nullptr));
        moved[p][i] -= 2.0 * kStep;
        ASSERT_TRUE(residual->Evaluate(moved, &below, nullptr));
        const PlaneResidual::Vector slope = (above - below) / (2.0 * kStep);
        EXPECT_LT((derivatives[p].col(i) - slope).norm(),
                  1e-5 * (1.0 + slope.norm()));
      }
    }
  }
}

TEST(PlaneResiduals, PlaneThroughTheCameraHasNone) {
  const Vector3d center(0.0, 0.0, 0.0);
  const Vector4d planes[2] = {{0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 1.0, -1.0}};
  const CreaseResidual residual(
      0, 1, center, {Vector3d(0.1, 0.1, 1.0), Vector3d(-0.2, 0.1, 1.0)}, 0.01);
  PlaneResidual::Vector values;
  EXPECT_FALSE(residual.Evaluate(planes, &values, nullptr));
}

TEST(PlaneParameters, DerivativesAreThoseOfTheCoefficients) {
  const Eigen::Matrix3d frame =
      Eigen::AngleAxisd(0.4, Vector3d(1.0, 2.0, 3.0).normalized())
          .toRotationMatrix();
  const PlaneParameters parameters(
      {PlaneThrough({0.1, 0.2, -1.0}, {1.0, 2.0, 3.0}), {-frame.col(1), 1.5}},
      {Vector3d(1.0, 2.0, 3.0), Vector3d(2.0, 1.0, 0.0)},
      {-1, 0},
      {-1, 1},
      {frame});
  EXPECT_EQ(parameters.Size(), 3 + 3 + 1);
  EXPECT_EQ(parameters.ToWorldPlane(1).normal, -frame.col(1));
  // Also where formulas for small angles are used.
  for (const double scale : {1e-4, 0.3}) {
    const std::vector<double> values = {
        scale, -scale, 2.0 * scale, -scale, scale, 0.7, 0.3};
    const auto evaluate = [&](int plane,
                              const std::vector<double>& at,
                              PlaneParameters::Derivatives* derivatives) {
      const double* blocks[2] = {};
      for (int i = 0; i < parameters.NumBlocks(plane); ++i) {
        blocks[i] = at.data() + parameters.BlockOf(plane, i).begin;
      }
      return parameters.Evaluate(plane, blocks, derivatives);
    };
    for (int plane = 0; plane < 2; ++plane) {
      PlaneParameters::Derivatives derivatives;
      const Vector4d coefficients = evaluate(plane, values, &derivatives);
      EXPECT_NEAR(coefficients.head<3>().norm(), 1.0, 1e-14);
      for (int b = 0; b < parameters.NumBlocks(plane); ++b) {
        const auto block = parameters.BlockOf(plane, b);
        for (int i = 0; i < block.size; ++i) {
          std::vector<double> above = values;
          std::vector<double> below = values;
          above[block.begin + i] += kStep;
          below[block.begin + i] -= kStep;
          const Vector4d slope = (evaluate(plane, above, nullptr) -
                                  evaluate(plane, below, nullptr)) /
                                 (2.0 * kStep);
          EXPECT_LT((derivatives[b].col(i) - slope).norm(), 1e-8);
        }
      }
      // Moving there and starting again gives the same plane.
      const PlaneParameters moved =
          parameters.MovedBy(values, {Vector3d::Zero(), Vector3d::Ones()});
      EXPECT_LT((Coefficients(moved.ToWorldPlane(plane)) - coefficients).norm(),
                1e-13);
    }
  }
}

}  // namespace
}  // namespace tsar
