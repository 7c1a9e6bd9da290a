// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/correct_prior.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/priors/axis_sample.h"
#include "colmap_tsar/priors/fit_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace tsar {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// The number of cells along the image's long side: the field is smooth.
constexpr int kGridSide = 64;
// The relative step of depth above which neighboring cells are of different
// surfaces, and the one below which they are of the same.
constexpr double kJump = 0.05;
constexpr double kNoJump = 0.03;
// A pixel belongs to the surface of its cell if its depth is this close.
constexpr float kSameSurface = 0.04f;
// The logarithm of the depth of cells without one: on no pixel's surface.
constexpr float kFar = 1e3f;
// Residuals beyond this many standard deviations measure another surface.
constexpr double kMaxResidual = 2.5;
// Cells with a smaller share of measured pixels count as not measured.
constexpr double kMinMeasured = 0.08;
// The distances, in cells, at which steps exceed the noise and are estimated.
constexpr int kLags[] = {8, 16, 24};
constexpr size_t kMinPairs = 20;
// The number of steps after which errors are uncorrelated, if not earlier.
constexpr double kCorrelationLength = 16.0;
constexpr double kMinVariance = 1e-7;
constexpr int kNumReweightings = 3;
constexpr double kMinWeight = 0.5;

using Matrix = Eigen::SparseMatrix<double>;
// A cell for each pixel of a row: its depth, offset and variance.
using CellsOfPixels = Eigen::Array<float, Eigen::Dynamic, 3>;

struct Step {
  size_t first = 0;
  size_t second = 0;
  double precision = 0.0;
};

double Square(double x) { return x * x; }

double MeanSquare(const std::vector<double>& values) {
  const auto size = static_cast<Eigen::Index>(values.size());
  return Eigen::Map<const Eigen::ArrayXd>(values.data(), size).square().mean();
}

class CorrectionField {
 public:
  CorrectionField(const Image<float>& log_depth, const Image<float>& residual)
      : log_depth_(log_depth),
        width_(GridSize(log_depth.Width(), log_depth)),
        height_(GridSize(log_depth.Height(), log_depth)) {
    DescribeCells();
    MeasureCells(residual);
    EstimateVariances();
    AddSteps();
    Solve();
  }

  // Interpolates the four cells around each pixel, mostly those of its surface.
  PriorCorrection Interpolate() const {
    const int width = log_depth_.Width();
    const int height = log_depth_.Height();
    PriorCorrection result{Image<float>::Uninitialized(width, height),
                           Image<float>::Uninitialized(width, height)};
    const std::vector<AxisSample> columns = AxisSamples(width_, width);
    Eigen::ArrayXf right(width);  // The share of the cells on the right.
    for (int x = 0; x < width; ++x) {
      right[x] = columns[x].share;
    }
    std::array<CellsOfPixels, 4> cells;
    int row_of_cells = -1;
    for (int y = 0; y < height; ++y) {
      const auto [first, second, below] = AxisSample::At(y, height_, height);
      if (first != row_of_cells) {
        row_of_cells = first;
        cells = {ExpandRow(first, columns, &AxisSample::first),
                 ExpandRow(first, columns, &AxisSample::second),
                 ExpandRow(second, columns, &AxisSample::first),
                 ExpandRow(second, columns, &AxisSample::second)};
      }
      const Eigen::Map<const Eigen::ArrayXf> depth(&log_depth_(0, y), width);
      Eigen::ArrayXf sum = Eigen::ArrayXf::Zero(width);
      Eigen::ArrayXf offset = sum;
      Eigen::ArrayXf variance = sum;
      for (size_t k = 0; k < 4; ++k) {
        const float of_row = k / 2 == 0 ? 1.f - below : below;
        const Eigen::ArrayXf near =
            (k % 2 == 0 ? 1.f - right : right) * of_row + 1e-3f;
        const Eigen::ArrayXf gap =
            ((cells[k].col(0) - depth) * static_cast<float>(1.0 / kNoJump))
                .square();
        const Eigen::ArrayXf weight =
            near / (1.f + gap.square()) + 1e-6f * near;
        sum += weight;
        offset += weight * cells[k].col(1);
        variance += weight * cells[k].col(2);
      }
      Eigen::Map<Eigen::ArrayXf>(&result.offset(0, y), width) = offset / sum;
      Eigen::Map<Eigen::ArrayXf>(&result.sigma(0, y), width) =
          (variance / sum).sqrt();
    }
    return result;
  }

 private:
  static int GridSize(int size, const Image<float>& image) {
    const int side = std::max(image.Width(), image.Height());
    return std::max(2, static_cast<int>(int64_t{kGridSide} * size / side));
  }

  // The first of the pixels, along a side of `num_pixels`, of a cell.
  static int FirstPixel(int cell, int num_pixels, int num_cells) {
    return static_cast<int>((int64_t{cell} * num_pixels + num_cells - 1) /
                            num_cells);
  }
  size_t NumCells() const {
    return static_cast<size_t>(width_) * static_cast<size_t>(height_);
  }

  // The depth of a cell is that of its middle pixel.
  void DescribeCells() {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        depths_.push_back(log_depth_(
            static_cast<int>((x + 0.5) * log_depth_.Width() / width_),
            static_cast<int>((y + 0.5) * log_depth_.Height() / height_)));
      }
    }
  }

  void MeasureCells(const Image<float>& residual) {
    std::vector<float> values;
    std::copy_if(residual.begin(),
                 residual.end(),
                 std::back_inserter(values),
                 [](float value) { return !std::isnan(value); });
    spread_ = values.empty() ? 0.0 : RobustSpread(values);
    const auto max_residual = static_cast<float>(kMaxResidual * spread_);
    const double pixels_per_cell = static_cast<double>(residual.NumPixels()) /
                                   static_cast<double>(NumCells());
    const auto min_count = static_cast<size_t>(
        std::max(1.0, std::ceil(kMinMeasured * pixels_per_cell)));
    medians_.assign(NumCells(), kNone);
    for (size_t cell = 0; cell < NumCells(); ++cell) {
      const int column = static_cast<int>(cell) % width_;
      const int row = static_cast<int>(cell) / width_;
      const int end_x = FirstPixel(column + 1, residual.Width(), width_);
      const int end_y = FirstPixel(row + 1, residual.Height(), height_);
      values.clear();
      for (int y = FirstPixel(row, residual.Height(), height_); y < end_y;
           ++y) {
        for (int x = FirstPixel(column, residual.Width(), width_); x < end_x;
             ++x) {
          const float value = residual(x, y);
          if (std::abs(value) <= max_residual &&
              std::abs(log_depth_(x, y) - depths_[cell]) < kSameSurface) {
            values.push_back(value);
          }
        }
      }
      if (values.size() >= min_count) {
        medians_[cell] = UpperMedian(&values);
        measured_.push_back(cell);
      }
    }
  }

  // Calls add(difference of medians, largest jump between) for all pairs of
  // measured cells that lie `lag` apart along a row or a column.
  template <typename Function>
  void ForEachPair(int lag, const Function& add) const {
    const auto visit = [&](int begin, int stride) {
      const auto at = [&](int k) {
        return static_cast<size_t>(begin + k * stride);
      };
      const double difference = medians_[at(lag)] - medians_[at(0)];
      if (std::isnan(difference)) {
        return;
      }
      double jump = 0.0;
      for (int k = 0; k < lag; ++k) {
        const double step = std::abs(depths_[at(k + 1)] - depths_[at(k)]);
        jump = std::isnan(step) ? 1.0 : std::max(jump, step);
      }
      add(difference, jump);
    };
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (x + lag < width_) {
          visit(y * width_ + x, 1);
        }
        if (y + lag < height_) {
          visit(y * width_ + x, width_);
        }
      }
    }
  }

  void EstimateVariances() {
    std::vector<double> near;
    std::vector<double> across;
    ForEachPair(1, [&](double difference, double jump) {
      if (jump < kNoJump) {
        near.push_back(difference);
      } else if (jump > kJump) {
        across.push_back(difference);
      }
    });
    const double total = std::max(Square(spread_), kMinVariance);
    noise_ = near.size() >= kMinPairs ? 0.5 * Square(RobustSpread(near))
                                      : 0.1 * total;
    noise_ = std::max(noise_, kMinVariance);
    // A smooth warp grows faster than a random walk.
    step_ = total / kCorrelationLength;
    for (const int lag : kLags) {
      std::vector<double> far;
      ForEachPair(lag, [&](double difference, double jump) {
        if (jump < kNoJump) {
          far.push_back(difference);
        }
      });
      if (far.size() >= kMinPairs) {
        step_ = std::max(step_, (MeanSquare(far) - 2.0 * noise_) / lag);
      }
    }
    const double of_jump =
        across.size() >= kMinPairs ? MeanSquare(across) - 2.0 * noise_ : total;
    jump_ = std::max(of_jump, 4.0 * step_);
    // The variance where nothing was measured.
    max_variance_ = 2.0 * (total + jump_);
  }

  void AddSteps() {
    const auto add = [&](size_t first, size_t second) {
      const double step = std::abs(depths_[first] - depths_[second]);
      if (!std::isnan(step)) {
        steps_.push_back(
            {first,
             second,
             1.0 / (step_ + jump_ * std::min(1.0, Square(step / kJump)))});
      }
    };
    const auto width = static_cast<size_t>(width_);
    for (size_t cell = 0; cell < NumCells(); ++cell) {
      if ((cell + 1) % width != 0) {
        add(cell, cell + 1);
      }
      if (cell + width < NumCells()) {
        add(cell, cell + width);
      }
    }
  }

  void Solve() {
    // The precision of a zero offset, too weak to change measured cells;
    // unmeasured surfaces stay where the fit of the whole image has them.
    const double anchor = 1e-3 / max_variance_;
    std::vector<Eigen::Triplet<double>> entries;  // Of the lower triangle.
    for (size_t i = 0; i < NumCells(); ++i) {
      entries.emplace_back(i, i, anchor);
    }
    for (const Step& step : steps_) {
      entries.emplace_back(step.first, step.first, step.precision);
      entries.emplace_back(step.second, step.second, step.precision);
      entries.emplace_back(step.second, step.first, -step.precision);
    }
    Matrix matrix(NumCells(), NumCells());
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd unmeasured = matrix.diagonal();
    std::vector<double> weights(measured_.size(), 1.0);
    Eigen::SimplicialLDLT<Matrix> solver;
    solver.analyzePattern(matrix);
    for (int i = 0; i <= kNumReweightings; ++i) {
      Eigen::VectorXd diagonal = unmeasured;
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unmeasured.size());
      for (size_t k = 0; k < measured_.size(); ++k) {
        const double precision = weights[k] / noise_;
        diagonal[measured_[k]] += precision;
        right[measured_[k]] = precision * medians_[measured_[k]];
      }
      matrix.diagonal() = diagonal;
      solver.factorize(matrix);
      offsets_ = solver.solve(right);
      if (i < kNumReweightings) {
        Reweight(&weights);
      }
    }
    EstimateVariancesOfCells(weights);
  }

  void Reweight(std::vector<double>* weights) const {
    std::vector<double> errors;
    for (const size_t cell : measured_) {
      errors.push_back(medians_[cell] - offsets_[cell]);
    }
    if (errors.empty()) {
      return;
    }
    const double scale =
        2.0 * std::max(RobustSpread(errors), std::sqrt(noise_));
    for (size_t k = 0; k < errors.size(); ++k) {
      (*weights)[k] = 1.0 / (1.0 + Square(errors[k] / scale));
    }
  }

  // The variance of each cell: the smallest sum of step variances on a path to
  // a measured cell. A posterior variance would hardly grow with the distance,
  // as that of a random walk in two dimensions.
  void EstimateVariancesOfCells(const std::vector<double>& weights) {
    variances_.assign(NumCells(), max_variance_);
    for (size_t k = 0; k < measured_.size(); ++k) {
      // Cells that contradict the field do not inform their neighbors.
      if (weights[k] > kMinWeight) {
        variances_[measured_[k]] = 0.0;
      }
    }
    bool is_changing = true;
    const auto shorten = [&](const Step& step) {
      double& first = variances_[step.first];
      double& second = variances_[step.second];
      const double of_step = 1.0 / step.precision;
      double& larger = first < second ? second : first;
      if (const double sum = std::min(first, second) + of_step; sum < larger) {
        larger = sum;
        is_changing = true;
      }
    };
    while (is_changing) {
      is_changing = false;
      std::for_each(steps_.begin(), steps_.end(), shorten);
      std::for_each(steps_.rbegin(), steps_.rend(), shorten);
    }
  }

  // For each pixel of a row the cell on its left or right.
  CellsOfPixels ExpandRow(int row,
                          const std::vector<AxisSample>& columns,
                          int AxisSample::*side) const {
    CellsOfPixels cells(columns.size(), 3);
    for (size_t x = 0; x < columns.size(); ++x) {
      const auto cell = static_cast<size_t>(row * width_ + columns[x].*side);
      cells.row(x) << (std::isnan(depths_[cell]) ? kFar : depths_[cell]),
          static_cast<float>(offsets_[cell]),
          static_cast<float>(variances_[cell] + noise_);
    }
    return cells;
  }

  const Image<float>& log_depth_;
  int width_;
  int height_;
  std::vector<float> depths_;   // Log depth of each cell.
  std::vector<float> medians_;  // Of the cell's residuals; NaN: none.
  std::vector<size_t> measured_;
  double spread_ = 0.0;
  double noise_ = 0.0;  // Variances: of a measured cell,
  double step_ = 0.0;   // of a step, and of one across a jump.
  double jump_ = 0.0;
  double max_variance_ = 0.0;
  std::vector<Step> steps_;
  Eigen::VectorXd offsets_;
  std::vector<double> variances_;
};

}  // namespace

PriorCorrection CorrectPrior(const Image<float>& log_depth,
                             const Image<float>& residual) {
  return CorrectionField(log_depth, residual).Interpolate();
}

}  // namespace tsar
