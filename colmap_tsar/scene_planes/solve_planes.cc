// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/solve_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <ceres/ceres.h>

namespace tsar {
namespace {

using Block = PlaneParameters::Block;

// One over the standard deviation of the numbers that nothing tells of.
constexpr double kStay = 1.0 / 32.0;

// A residual as a function of the blocks of its planes, of which two planes of
// one frame share one.
class ResidualOfBlocks {
 public:
  static constexpr int kMaxBlocks = 4;
  using Derivatives = Eigen::Matrix<double, PlaneResidual::kMaxSize, 3>;

  ResidualOfBlocks(const PlaneParameters& parameters,
                   const PlaneResidual& residual)
      : parameters_(&parameters), residual_(&residual) {
    for (int i = 0; i < residual.NumPlanes(); ++i) {
      const int plane = residual.PlaneAt(i);
      for (int k = 0; k < parameters.NumBlocks(plane); ++k) {
        const Block block = parameters.BlockOf(plane, k);
        int number = 0;
        while (number < num_blocks_ && blocks_[number].begin != block.begin) {
          ++number;
        }
        if (number == num_blocks_) {
          blocks_[num_blocks_++] = block;
        }
        numbers_[i][k] = number;
      }
    }
  }

  int NumBlocks() const { return num_blocks_; }
  Block BlockAt(int number) const { return blocks_[number]; }
  const PlaneResidual& Residual() const { return *residual_; }

  // derivatives: one for each block, of which the first rows and columns are
  // used; or null.
  bool Evaluate(const double* const* blocks,
                PlaneResidual::Vector* residuals,
                Derivatives* derivatives) const {
    Eigen::Vector4d planes[2];
    PlaneParameters::Derivatives by_blocks[2];
    for (int i = 0; i < residual_->NumPlanes(); ++i) {
      const double* of_plane[2] = {blocks[numbers_[i][0]],
                                   blocks[numbers_[i][1]]};
      planes[i] = parameters_->Evaluate(
          residual_->PlaneAt(i),
          of_plane,
          derivatives == nullptr ? nullptr : &by_blocks[i]);
    }
    PlaneResidual::Derivatives by_planes[2];
    if (!residual_->Evaluate(
            planes, residuals, derivatives == nullptr ? nullptr : by_planes)) {
      return false;
    }
    if (derivatives != nullptr) {
      std::fill_n(derivatives, num_blocks_, Derivatives::Zero());
      const int size = residual_->Size();
      for (int i = 0; i < residual_->NumPlanes(); ++i) {
        const int plane = residual_->PlaneAt(i);
        for (int k = 0; k < parameters_->NumBlocks(plane); ++k) {
          const int columns = parameters_->BlockOf(plane, k).size;
          derivatives[numbers_[i][k]].topLeftCorner(size, columns) +=
              by_planes[i] * by_blocks[i][k].leftCols(columns);
        }
      }
    }
    for (int i = 0; derivatives != nullptr && i < num_blocks_; ++i) {
      if (!derivatives[i].allFinite()) {
        return false;
      }
    }
    return residuals->allFinite();
  }

 private:
  const PlaneParameters* parameters_;
  const PlaneResidual* residual_;
  int num_blocks_ = 0;
  std::array<Block, kMaxBlocks> blocks_;
  // Of each plane's blocks among these.
  std::array<std::array<int, 2>, 2> numbers_ = {};
};

class ResidualCost : public ceres::CostFunction {
 public:
  explicit ResidualCost(const ResidualOfBlocks& residual)
      : residual_(residual) {
    set_num_residuals(residual.Residual().Size());
    for (int i = 0; i < residual.NumBlocks(); ++i) {
      mutable_parameter_block_sizes()->push_back(residual.BlockAt(i).size);
    }
  }

  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    PlaneResidual::Vector values;
    ResidualOfBlocks::Derivatives derivatives[ResidualOfBlocks::kMaxBlocks];
    if (!residual_.Evaluate(parameters,
                            &values,
                            jacobians == nullptr ? nullptr : derivatives)) {
      return false;
    }
    std::copy(values.begin(), values.end(), residuals);
    for (int i = 0; jacobians != nullptr && i < residual_.NumBlocks(); ++i) {
      for (int row = 0; jacobians[i] != nullptr && row < values.size(); ++row) {
        const int size = residual_.BlockAt(i).size;
        for (int col = 0; col < size; ++col) {
          jacobians[i][row * size + col] = derivatives[i](row, col);
        }
      }
    }
    return true;
  }

 private:
  ResidualOfBlocks residual_;
};

// Weakly pulls the numbers of a block to 0.
class StayCost : public ceres::CostFunction {
 public:
  explicit StayCost(int size) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->push_back(size);
  }

  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const int size = num_residuals();
    for (int i = 0; i < size; ++i) {
      residuals[i] = kStay * parameters[0][i];
    }
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      for (int i = 0; i < size * size; ++i) {
        jacobians[0][i] = i % (size + 1) == 0 ? kStay : 0.0;
      }
    }
    return true;
  }
};

std::vector<Block> AllBlocks(const PlaneParameters& parameters) {
  std::vector<Block> blocks;
  for (int f = 0; f < parameters.NumFrames(); ++f) {
    blocks.push_back(parameters.FrameBlock(f));
  }
  for (int p = 0; p < parameters.NumPlanes(); ++p) {
    blocks.push_back(parameters.OwnBlock(p));
  }
  return blocks;
}

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Of these libraries the only one whose sums do not depend on the machine.
  if (ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE)) {
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  }
  options.num_threads = 1;
  // Planes are measured and adjusted again, so what is left is small.
  options.max_num_iterations = 10;
  options.function_tolerance = 1e-7;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

std::vector<double> SolvePlanes(const PlaneParameters& parameters,
                                const PlaneResiduals& residuals,
                                double loss_scale) {
  std::vector<double> values(parameters.Size(), 0.0);
  if (values.empty()) {
    return values;
  }
  ceres::CauchyLoss loss(loss_scale);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  // First, so that the order of the blocks is that of the numbers.
  for (const Block& block : AllBlocks(parameters)) {
    problem.AddResidualBlock(
        new StayCost(block.size), nullptr, values.data() + block.begin);
  }
  std::vector<double*> blocks;
  for (const auto& residual : residuals) {
    const ResidualOfBlocks of_blocks(parameters, *residual);
    blocks.clear();
    for (int i = 0; i < of_blocks.NumBlocks(); ++i) {
      blocks.push_back(values.data() + of_blocks.BlockAt(i).begin);
    }
    problem.AddResidualBlock(new ResidualCost(of_blocks),
                             residual->IsRobust() ? &loss : nullptr,
                             blocks);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(), &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    std::fill(values.begin(), values.end(), 0.0);
  }
  return values;
}

Eigen::SparseMatrix<double> PlaneInformation(const PlaneParameters& parameters,
                                             const PlaneResiduals& residuals,
                                             double loss_scale) {
  using Triplet = Eigen::Triplet<double>;
  const int size = parameters.Size();
  std::vector<Triplet> entries;
  for (int i = 0; i < size; ++i) {
    entries.emplace_back(i, i, kStay * kStay);
  }
  const double zeros[3] = {};
  const double* blocks[ResidualOfBlocks::kMaxBlocks] = {
      zeros, zeros, zeros, zeros};
  for (const auto& residual : residuals) {
    const ResidualOfBlocks of_blocks(parameters, *residual);
    PlaneResidual::Vector values;
    ResidualOfBlocks::Derivatives derivatives[ResidualOfBlocks::kMaxBlocks];
    if (!of_blocks.Evaluate(blocks, &values, derivatives)) {
      continue;
    }
    const double weight =
        residual->IsRobust()
            ? 1.0 / (1.0 + values.squaredNorm() / (loss_scale * loss_scale))
            : 1.0;
    for (int i = 0; i < of_blocks.NumBlocks(); ++i) {
      for (int k = 0; k < of_blocks.NumBlocks(); ++k) {
        const Block rows = of_blocks.BlockAt(i);
        const Block cols = of_blocks.BlockAt(k);
        const Eigen::Matrix3d product =
            weight * derivatives[i].transpose() * derivatives[k];
        for (int row = 0; row < rows.size; ++row) {
          for (int col = 0; col < cols.size; ++col) {
            entries.emplace_back(
                rows.begin + row, cols.begin + col, product(row, col));
          }
        }
      }
    }
  }
  Eigen::SparseMatrix<double> information(size, size);
  information.setFromTriplets(entries.begin(), entries.end());
  return information;
}

}  // namespace tsar
