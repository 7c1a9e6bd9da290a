// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/find_cylinders.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/scene/surfaces/common_heights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace tsar {
namespace {

// Lengths are in pixels of the views' rasters.
// The least number of views that show both outlines,
constexpr size_t kMinViews = 4;
// their largest residual,
constexpr double kMaxDifference = 1.3;
// and the largest root mean square of residuals.
constexpr double kMaxResidual = 0.3;
// The outlines of a cylinder are different lines of it in each view. Two
// fixed lines, such as the edges of a board, must have a residual larger by
// this factor, where residuals below the least are errors of edges.
constexpr double kMinRatio = 2.0;
constexpr double kLeastResidual = 0.125;
// The least median of the widths in views, and the least length along the
// axis that at least half of the views show.
constexpr double kMinWidth = 12.0;
constexpr double kMinLength = 20.0;

constexpr int kFitRounds = 3;
// The number of hypotheses that are fitted at a time.
constexpr size_t kFitBatch = 64;

// A view that shows both outlines of a circle.
struct Support {
  const OutlineView* view = nullptr;
  const OutlinePair* pair = nullptr;
};
using Supports = std::vector<Support>;

struct Hypothesis {
  AxisCircle circle;
  HeightRange heights;  // Common to both proposing views.
  // The views that propose it, and the number of views around that show it,
  // with their total number of rows.
  size_t first = 0;
  size_t second = 0;
  size_t num_views = 0;
  size_t num_rows = 0;
};

std::vector<CircleTangent> TangentsOf(const Supports& supports) {
  std::vector<CircleTangent> tangents;
  for (const Support& support : supports) {
    const AxisCamera* camera = &support.view->camera;
    tangents.push_back({camera, support.pair->left, true});
    tangents.push_back({camera, support.pair->right, false});
  }
  return tangents;
}

bool Agrees(const OutlinePair& pair,
            const CircleOutline& outline,
            double max_difference) {
  return std::abs(pair.left - outline.left) <= max_difference &&
         std::abs(pair.right - outline.right) <= max_difference;
}

// The interval of the axis in which a pair is seen.
HeightRange HeightsOf(const OutlinePair& pair,
                      const AxisCamera& camera,
                      const CircleOutline& outline) {
  const double distance = outline.MeanDistance();
  return {camera.Height(pair.rows.front(), distance),
          camera.Height(pair.rows.back(), distance)};
}

double Squared(double x) { return x * x; }

class CylinderFinder {
 public:
  CylinderFinder(const std::vector<OutlineView>& views,
                 const std::vector<std::vector<size_t>>& neighbors)
      : views_(views), neighbors_(neighbors) {}

  std::vector<Hypothesis> FindHypotheses(ThreadPool& threads) const {
    std::vector<std::vector<Hypothesis>> of_views(views_.size());
    threads.ForEach(of_views.size(), [&](size_t i) {
      for (const size_t j : neighbors_[i]) {
        if (j > i) {
          FindInTwo(i, j, &of_views[i]);
        }
      }
    });
    std::vector<Hypothesis> hypotheses;
    for (const std::vector<Hypothesis>& of_view : of_views) {
      hypotheses.insert(hypotheses.end(), of_view.begin(), of_view.end());
    }
    std::ranges::stable_sort(
        hypotheses, std::greater{}, [](const Hypothesis& hypothesis) {
          return std::tuple(hypothesis.num_views, hypothesis.num_rows);
        });
    return hypotheses;
  }

  // The cylinders of a hypothesis, fitted to all views around that show it: one
  // for each common interval of heights.
  std::vector<ModelCylinder> Fit(const Hypothesis& hypothesis,
                                 const AxisFrame& frame) const {
    AxisCircle circle = hypothesis.circle;
    const std::vector<size_t> around =
        ViewsAround(hypothesis.first, hypothesis.second);
    Supports supports;
    Eigen::Matrix3d covariance;
    for (int round = 0; round < kFitRounds; ++round) {
      supports = FindSupports(circle, hypothesis.heights, around);
      if (supports.size() < kMinViews) {
        return {};
      }
      const std::optional<AxisCircle> fitted =
          FitCircle(TangentsOf(supports), &circle, &covariance);
      if (!fitted) {
        return {};
      }
      circle = *fitted;
    }
    const std::optional<double> residual = Residual(supports, circle);
    if (!residual || *residual > kMaxResidual ||
        !IsRound(supports, *residual) || MedianWidth(supports) < kMinWidth) {
      return {};
    }
    ModelCylinder cylinder;
    cylinder.frame = frame;
    cylinder.point =
        circle.center.x() * frame.across + circle.center.y() * frame.Third();
    cylinder.radius = circle.radius;
    cylinder.covariance =
        covariance * Squared(std::max(*residual, kLeastResidual));
    std::vector<ModelCylinder> cylinders;
    for (const HeightRange& range : CommonHeights(supports, circle)) {
      cylinder.min_height = range.min;
      cylinder.max_height = range.max;
      cylinders.push_back(cylinder);
    }
    return cylinders;
  }

 private:
  // Two views and their neighbors.
  std::vector<size_t> ViewsAround(size_t first, size_t second) const {
    std::set<size_t> around = {first, second};
    around.insert(neighbors_[first].begin(), neighbors_[first].end());
    around.insert(neighbors_[second].begin(), neighbors_[second].end());
    return {around.begin(), around.end()};
  }

  // Adds circles that two views may show and that enough views around support.
  void FindInTwo(size_t first,
                 size_t second,
                 std::vector<Hypothesis>* hypotheses) const {
    const std::vector<size_t> around = ViewsAround(first, second);
    for (const OutlinePair& a : views_[first].pairs) {
      for (const OutlinePair& b : views_[second].pairs) {
        if (!MayShowOneCircle({views_[first].camera, a.left, a.right},
                              {views_[second].camera, b.left, b.right})) {
          continue;
        }
        const Supports two = {{&views_[first], &a}, {&views_[second], &b}};
        const std::optional<AxisCircle> circle =
            FitCircle(TangentsOf(two), nullptr, nullptr);
        const std::optional<HeightRange> heights =
            circle ? ExplainedHeights(*circle, two) : std::nullopt;
        if (!heights) {
          continue;
        }
        const Supports supports = FindSupports(*circle, *heights, around);
        if (supports.size() < kMinViews) {
          continue;
        }
        size_t num_rows = 0;
        for (const Support& support : supports) {
          num_rows += support.pair->rows.size();
        }
        hypotheses->push_back(
            {*circle, *heights, first, second, supports.size(), num_rows});
      }
    }
  }

  // The heights at which both views show both outlines of the circle.
  std::optional<HeightRange> ExplainedHeights(const AxisCircle& circle,
                                              const Supports& two) const {
    HeightRange heights[2];
    for (size_t i = 0; i < 2; ++i) {
      const AxisCamera& camera = two[i].view->camera;
      const std::optional<CircleOutline> outline = OutlineOf(circle, camera);
      if (!outline || !Agrees(*two[i].pair, *outline, kMaxDifference)) {
        return std::nullopt;
      }
      heights[i] = HeightsOf(*two[i].pair, camera, *outline);
    }
    return heights[0].Overlaps(heights[1])
               ? std::optional(heights[0].Intersection(heights[1]))
               : std::nullopt;
  }

  // In each view the pair with the most rows that agrees with the circle and
  // overlaps the heights.
  Supports FindSupports(const AxisCircle& circle,
                        const HeightRange& heights,
                        const std::vector<size_t>& views) const {
    Supports supports;
    for (const size_t i : views) {
      const std::optional<CircleOutline> outline =
          OutlineOf(circle, views_[i].camera);
      const OutlinePair* best = nullptr;
      for (const OutlinePair& pair : views_[i].pairs) {
        if (outline && Agrees(pair, *outline, kMaxDifference) &&
            (best == nullptr || pair.rows.size() > best->rows.size()) &&
            HeightsOf(pair, views_[i].camera, *outline).Overlaps(heights)) {
          best = &pair;
        }
      }
      if (best != nullptr) {
        supports.push_back({&views_[i], best});
      }
    }
    return supports;
  }

  // The root mean square of the outlines' residuals, in pixels.
  static std::optional<double> Residual(const Supports& supports,
                                        const AxisCircle& circle) {
    double sum = 0.0;
    for (const Support& support : supports) {
      const std::optional<CircleOutline> outline =
          OutlineOf(circle, support.view->camera);
      if (!outline) {
        return std::nullopt;
      }
      sum += Squared(support.pair->left - outline->left) +
             Squared(support.pair->right - outline->right);
    }
    return std::sqrt(sum / (2.0 * supports.size()));
  }

  // Whether two fixed lines explain the outlines much worse than the circle.
  bool IsRound(const Supports& supports, double residual) const {
    double sum = 0.0;
    for (const bool is_left : {true, false}) {
      std::vector<CircleTangent> side = TangentsOf(supports);
      std::erase_if(side, [&](const CircleTangent& tangent) {
        return tangent.is_left != is_left;
      });
      const std::optional<Eigen::Vector2d> point = FitPoint(side);
      for (const CircleTangent& tangent : side) {
        const std::optional<CircleOutline> seen =
            point ? OutlineOf({*point, 0.0}, *tangent.camera) : std::nullopt;
        if (!seen) {
          return false;
        }
        sum += Squared(seen->left - tangent.column);
      }
    }
    const double residual_of_lines = std::sqrt(sum / (2.0 * supports.size()));
    return residual_of_lines >= kMinRatio * std::max(residual, kLeastResidual);
  }

  static double MedianWidth(const Supports& supports) {
    std::vector<double> widths;
    for (const Support& support : supports) {
      widths.push_back(support.pair->right - support.pair->left);
    }
    return UpperMedian(&widths);
  }

  // The intervals that at least half of the views show.
  std::vector<HeightRange> CommonHeights(const Supports& supports,
                                         const AxisCircle& circle) const {
    std::vector<std::vector<double>> heights;
    double bin = 0.0;  // The coarsest view leaves no gaps.
    for (const Support& support : supports) {
      const AxisCamera& camera = support.view->camera;
      const std::optional<CircleOutline> outline = OutlineOf(circle, camera);
      if (!outline) {
        return {};
      }
      const double distance = outline->MeanDistance();
      bin = std::max(bin, distance / camera.focal);
      heights.emplace_back();
      for (const int row : support.pair->rows) {
        heights.back().push_back(camera.Height(row, distance));
      }
    }
    std::vector<HeightRange> ranges =
        FindCommonHeights(heights, bin, (supports.size() + 1) / 2);
    std::erase_if(ranges, [&](const HeightRange& range) {
      return range.Length() < kMinLength * bin;
    });
    return ranges;
  }

  const std::vector<OutlineView>& views_;
  const std::vector<std::vector<size_t>>& neighbors_;
};

// Whether a circle intersects a cylinder, or is inside, at some of these
// heights.
bool IsIn(const ModelCylinder& cylinder,
          const AxisCircle& circle,
          const HeightRange& heights) {
  return (circle.center - cylinder.frame.Across(cylinder.point)).norm() <
             circle.radius + cylinder.radius &&
         heights.Overlaps({cylinder.min_height, cylinder.max_height});
}

}  // namespace

std::vector<ModelCylinder> FindCylinders(
    const std::vector<OutlineView>& views,
    const std::vector<std::vector<size_t>>& neighbors,
    const AxisFrame& frame,
    ThreadPool& threads) {
  const CylinderFinder finder(views, neighbors);
  std::vector<ModelCylinder> cylinders;
  const auto is_taken = [&](const AxisCircle& circle,
                            const HeightRange& heights) {
    return std::ranges::any_of(cylinders, [&](const ModelCylinder& other) {
      return IsIn(other, circle, heights);
    });
  };
  const std::vector<Hypothesis> hypotheses = finder.FindHypotheses(threads);
  for (size_t begin = 0; begin < hypotheses.size(); begin += kFitBatch) {
    const size_t count = std::min(kFitBatch, hypotheses.size() - begin);
    std::vector<std::vector<ModelCylinder>> fits(count);
    threads.ForEach(count, [&](size_t i) {
      const Hypothesis& hypothesis = hypotheses[begin + i];
      if (!is_taken(hypothesis.circle, hypothesis.heights)) {
        fits[i] = finder.Fit(hypothesis, frame);
      }
    });
    for (size_t i = 0; i < count; ++i) {
      const Hypothesis& hypothesis = hypotheses[begin + i];
      // A cylinder of the same batch may have taken it.
      if (is_taken(hypothesis.circle, hypothesis.heights)) {
        continue;
      }
      for (const ModelCylinder& cylinder : fits[i]) {
        if (!is_taken({frame.Across(cylinder.point), cylinder.radius},
                      {cylinder.min_height, cylinder.max_height})) {
          cylinders.push_back(cylinder);
        }
      }
    }
  }
  return cylinders;
}

}  // namespace tsar
