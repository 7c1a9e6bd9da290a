// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/correct_prior.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/priors/fit_prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

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

struct Step {
  int first = 0;
  int second = 0;
  double precision = 0.0;
};

double Square(double x) { return x * x; }

double MeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return sum / static_cast<double>(values.size());
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

  PriorCorrection Interpolate() const {
    PriorCorrection result{
        Image<float>(log_depth_.Width(), log_depth_.Height(), kNone),
        Image<float>(log_depth_.Width(), log_depth_.Height(), kNone)};
    for (int y = 0; y < log_depth_.Height(); ++y) {
      for (int x = 0; x < log_depth_.Width(); ++x) {
        const float depth = log_depth_(x, y);
        if (!std::isnan(depth)) {
          InterpolateAt(x, y, depth, &result);
        }
      }
    }
    return result;
  }

 private:
  static int GridSize(int size, const Image<float>& image) {
    const int side = std::max(image.Width(), image.Height());
    return std::max(2, static_cast<int>(int64_t{kGridSide} * size / side));
  }

  int CellX(int x) const {
    return static_cast<int>(int64_t{x} * width_ / log_depth_.Width());
  }
  int CellY(int y) const {
    return static_cast<int>(int64_t{y} * height_ / log_depth_.Height());
  }
  size_t NumCells() const {
    return static_cast<size_t>(width_) * static_cast<size_t>(height_);
  }

  // The depth of a cell is that of its middle pixel.
  void DescribeCells() {
    depths_.assign(NumCells(), kNone);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        depths_[static_cast<size_t>(y * width_ + x)] = log_depth_(
            static_cast<int>((x + 0.5) * log_depth_.Width() / width_),
            static_cast<int>((y + 0.5) * log_depth_.Height() / height_));
      }
    }
  }

  void MeasureCells(const Image<float>& residual) {
    std::vector<double> all;
    for (const float value : residual) {
      if (!std::isnan(value)) {
        all.push_back(value);
      }
    }
    spread_ = all.empty() ? 0.0 : RobustSpread(std::move(all));
    std::vector<std::vector<double>> of_cells(NumCells());
    for (int y = 0; y < residual.Height(); ++y) {
      for (int x = 0; x < residual.Width(); ++x) {
        const auto cell = static_cast<size_t>(CellY(y) * width_ + CellX(x));
        const float value = residual(x, y);
        if (std::abs(value) <= kMaxResidual * spread_ &&
            std::abs(log_depth_(x, y) - depths_[cell]) < kSameSurface) {
          of_cells[cell].push_back(value);
        }
      }
    }
    const double pixels_per_cell = static_cast<double>(residual.NumPixels()) /
                                   static_cast<double>(NumCells());
    const auto min_count = static_cast<size_t>(
        std::max(1.0, std::ceil(kMinMeasured * pixels_per_cell)));
    medians_.assign(NumCells(), std::numeric_limits<double>::quiet_NaN());
    for (size_t i = 0; i < of_cells.size(); ++i) {
      std::vector<double>& values = of_cells[i];
      if (values.size() >= min_count) {
        medians_[i] = UpperMedian(&values);
        measured_.push_back(static_cast<int>(i));
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
    const auto add = [&](int first, int second) {
      const double step = std::abs(depths_[static_cast<size_t>(first)] -
                                   depths_[static_cast<size_t>(second)]);
      if (!std::isnan(step)) {
        steps_.push_back(
            {first,
             second,
             1.0 / (step_ + jump_ * std::min(1.0, Square(step / kJump)))});
      }
    };
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const int cell = y * width_ + x;
        if (x + 1 < width_) {
          add(cell, cell + 1);
        }
        if (y + 1 < height_) {
          add(cell, cell + width_);
        }
      }
    }
  }

  Matrix Precision(const std::vector<double>& weights) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * steps_.size() + 2 * NumCells());
    for (size_t i = 0; i < NumCells(); ++i) {
      entries.emplace_back(i, i, Anchor());
    }
    for (size_t k = 0; k < measured_.size(); ++k) {
      entries.emplace_back(measured_[k], measured_[k], weights[k] / noise_);
    }
    for (const Step& step : steps_) {
      entries.emplace_back(step.first, step.first, step.precision);
      entries.emplace_back(step.second, step.second, step.precision);
      entries.emplace_back(step.first, step.second, -step.precision);
      entries.emplace_back(step.second, step.first, -step.precision);
    }
    const auto size = static_cast<Eigen::Index>(NumCells());
    Matrix matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  // The precision of a zero offset, too weak to change measured cells;
  // unmeasured surfaces stay where the fit of the whole image has them.
  double Anchor() const { return 1e-3 / max_variance_; }

  void Solve() {
    const auto size = static_cast<Eigen::Index>(NumCells());
    std::vector<double> weights(measured_.size(), 1.0);
    Eigen::SimplicialLDLT<Matrix> solver;
    solver.analyzePattern(Precision(weights));
    offsets_ = Eigen::VectorXd::Zero(size);
    for (int i = 0; i <= kNumReweightings; ++i) {
      solver.factorize(Precision(weights));
      Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
      for (size_t k = 0; k < measured_.size(); ++k) {
        right[measured_[k]] =
            weights[k] * medians_[static_cast<size_t>(measured_[k])] / noise_;
      }
      offsets_ = solver.solve(right);
      if (i < kNumReweightings) {
        Reweight(&weights);
      }
    }
    EstimateVariancesOfCells(weights);
  }

  void Reweight(std::vector<double>* weights) const {
    std::vector<double> errors;
    for (const int cell : measured_) {
      errors.push_back(medians_[static_cast<size_t>(cell)] - offsets_[cell]);
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
    std::vector<std::vector<std::pair<int, double>>> neighbors(NumCells());
    for (const Step& step : steps_) {
      const double variance = 1.0 / step.precision;
      neighbors[static_cast<size_t>(step.first)].emplace_back(step.second,
                                                              variance);
      neighbors[static_cast<size_t>(step.second)].emplace_back(step.first,
                                                               variance);
    }
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (size_t k = 0; k < measured_.size(); ++k) {
      // Cells that contradict the field tell nothing about their neighbors.
      if (weights[k] > kMinWeight) {
        variances_[static_cast<size_t>(measured_[k])] = 0.0;
        queue.emplace(0.0, measured_[k]);
      }
    }
    while (!queue.empty()) {
      const auto [variance, cell] = queue.top();
      queue.pop();
      if (variance > variances_[static_cast<size_t>(cell)]) {
        continue;
      }
      for (const auto& [next, of_step] : neighbors[static_cast<size_t>(cell)]) {
        double& known = variances_[static_cast<size_t>(next)];
        if (variance + of_step < known) {
          known = variance + of_step;
          queue.emplace(known, next);
        }
      }
    }
  }

  // Interpolates the four cells around, mostly those of the pixel's surface.
  void InterpolateAt(int x,
                     int y,
                     float depth,
                     PriorCorrection* correction) const {
    const double u = std::clamp((x + 0.5) * width_ / log_depth_.Width() - 0.5,
                                0.0,
                                static_cast<double>(width_ - 1));
    const double v = std::clamp((y + 0.5) * height_ / log_depth_.Height() - 0.5,
                                0.0,
                                static_cast<double>(height_ - 1));
    const int x0 = std::min(static_cast<int>(u), width_ - 2);
    const int y0 = std::min(static_cast<int>(v), height_ - 2);
    double sum = 0.0;
    double offset = 0.0;
    double variance = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int cx = x0 + k % 2;
      const int cy = y0 + k / 2;
      const int cell = cy * width_ + cx;
      const double gap =
          static_cast<double>(depths_[static_cast<size_t>(cell)]) - depth;
      if (std::isnan(gap)) {
        continue;
      }
      constexpr double kLeast = 1e-6;
      const double near =
          (1.0 - std::abs(u - cx)) * (1.0 - std::abs(v - cy)) + 1e-3;
      const double weight =
          near * (1.0 / (1.0 + std::pow(gap / kNoJump, 4)) + kLeast);
      sum += weight;
      offset += weight * offsets_[cell];
      variance += weight * variances_[static_cast<size_t>(cell)];
    }
    correction->offset(x, y) =
        sum > 0.0 ? static_cast<float>(offset / sum) : 0.f;
    correction->sigma(x, y) = static_cast<float>(
        std::sqrt((sum > 0.0 ? variance / sum : max_variance_) + noise_));
  }

  const Image<float>& log_depth_;
  int width_;
  int height_;
  std::vector<float> depths_;    // Log depth of each cell.
  std::vector<double> medians_;  // Of the cell's residuals; NaN: none.
  std::vector<int> measured_;
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
