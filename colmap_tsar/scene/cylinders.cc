// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/cylinders.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/base/plane.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <utility>

#include <Eigen/LU>
#include <Eigen/QR>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// Lengths in images are in pixels of the views' rasters.

// An edge has at least this slope, in gray levels per pixel: half of the slope
// at a step of four, smoothed.
constexpr float kMinSlope = 1.5f;
// The border of the raster in which there are no edges.
constexpr int kMargin = 4;
// The widths and the least number of rows of a pair of edges, how far its edges
// may lie from its own columns, and the largest strength of edges between the
// two, relative to the weaker one.
constexpr float kMinWidth = 10.f;
constexpr float kMaxWidth = 400.f;
constexpr size_t kMinRows = 20;
constexpr float kTolerance = 1.5f;
constexpr float kMaxBetween = 0.6f;

// The least number of views that show both outlines of a cylinder,
constexpr size_t kMinViews = 4;
// their largest difference from it,
constexpr double kMaxDifference = 1.3;
// and the largest root mean square of the residuals.
constexpr double kMaxResidual = 0.3;
// The outlines of a cylinder are different lines of it in each view. Two fixed
// lines, such as the edges of a board, must have a residual larger by this
// factor, where residuals below the least are errors of edges.
constexpr double kMinRatio = 2.0;
constexpr double kLeastResidual = 0.125;
// The least median of the widths in views, and the least length.
constexpr double kMinMedianWidth = 12.0;
constexpr double kMinLength = 20.0;
constexpr int kFitRounds = 3;

// A depth of another surface is farther from the cylinder than this, in
// relative depths of one pixel of disparity.
constexpr float kMinGap = 3.f;

// The camera of a view turned about its center so that the columns of its image
// are parallel to an axis, and each is a direction in the plane across it.
struct AxisCamera {
  int width = 0;
  int height = 0;
  double focal = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  // From its pixels to those of the view's raster, in homogeneous coordinates.
  Eigen::Matrix3d to_raster;
  // The camera center and unit vectors, in the plane across the axis.
  Eigen::Vector2d center;
  Eigen::Vector2d right;
  Eigen::Vector2d forward;
  double center_height = 0.0;

  // The direction of a column; not of unit length.
  Eigen::Vector2d Direction(double column) const {
    return forward + (column - cx) / focal * right;
  }
  // The height of a row at a distance along `forward`.
  double Height(double row, double distance) const {
    return center_height + (row - cy) / focal * distance;
  }
  double PixelAt(const Eigen::Vector2d& point) const {
    return (point - center).norm() / focal;
  }
};

// Nothing where the optical axis is nearly parallel to the axis, or where the
// turned image would be many times as large as the raster.
std::optional<AxisCamera> MakeAxisCamera(const Camera& camera,
                                         const AxisFrame& frame) {
  // The least cosine between the optical axis and the plane across the axis,
  // the least depth of the image's corners at a depth of one in the view, the
  // largest extent of the image in focal lengths, and its largest size.
  constexpr double kMinCosine = 0.6;
  constexpr double kMinCornerDepth = 0.2;
  constexpr double kMaxSlope = 1.5;
  const double max_size = 4.0 * (double(camera.width) + camera.height);
  const Eigen::Vector3d optical_axis = camera.rotation.row(2);
  Eigen::Vector3d forward =
      optical_axis - frame.along * frame.along.dot(optical_axis);
  if (!(forward.norm() >= kMinCosine)) {
    return std::nullopt;
  }
  forward.normalize();
  const Eigen::Vector3d right = frame.along.cross(forward);
  AxisCamera result;
  // Of the longer side of pixels that are not square.
  result.focal = std::min(camera.fx, camera.fy);
  result.center = frame.Across(camera.Center());
  result.center_height = frame.along.dot(camera.Center());
  result.right = frame.Across(right);
  result.forward = frame.Across(forward);
  Eigen::Matrix3d axes;
  axes << right, frame.along, forward;
  Eigen::Matrix3d of_view;
  of_view << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0,
      1.0;
  const Eigen::Matrix3d from_ray = of_view * camera.rotation * axes;
  const Eigen::Matrix3d to_ray = from_ray.inverse();
  Eigen::Array2d low = Eigen::Array2d::Constant(HUGE_VAL);
  Eigen::Array2d high = -low;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      const Eigen::Vector3d ray = to_ray * Eigen::Vector3d(x, y, 1.0);
      if (!(ray.z() > kMinCornerDepth)) {
        return std::nullopt;
      }
      low = low.min(ray.head<2>().array() / ray.z());
      high = high.max(ray.head<2>().array() / ray.z());
    }
  }
  low = low.max(-kMaxSlope);
  const Eigen::Array2d size = (high.min(kMaxSlope) - low) * result.focal;
  // Not where a coordinate is no number.
  if (!(size.minCoeff() >= 0.0) || !(size.maxCoeff() <= max_size)) {
    return std::nullopt;
  }
  result.cx = -low.x() * result.focal;
  result.cy = -low.y() * result.focal;
  result.width = static_cast<int>(size.x()) + 1;
  result.height = static_cast<int>(size.y()) + 1;
  Eigen::Matrix3d to_slopes;
  to_slopes << 1.0, 0.0, -result.cx, 0.0, 1.0, -result.cy, 0.0, 0.0,
      result.focal;
  result.to_raster = from_ray * to_slopes;
  return result;
}

// An edge across the axis in a row of the turned image.
struct Edge {
  float column;    // With subpixel precision.
  float strength;  // Slope of color, in gray levels per pixel.
};

// For each row the local maxima of the color slope, by ascending columns.
std::vector<std::vector<Edge>> FindEdges(const Image<Rgb>& color,
                                         const AxisCamera& camera) {
  std::vector<std::vector<Edge>> edges(camera.height);
  const cv::Rect inside(kMargin,
                        kMargin,
                        color.Width() - 2 * kMargin,
                        color.Height() - 2 * kMargin);
  if (inside.width <= 0 || inside.height <= 0) {
    return edges;
  }
  cv::Mat raster(
      color.Height(), color.Width(), CV_8UC3, const_cast<Rgb*>(color.Data()));
  cv::Mat validity = cv::Mat::zeros(raster.size(), CV_8U);
  validity(inside).setTo(1);
  raster.convertTo(raster, CV_32F);
  cv::Mat to_raster;
  cv::eigen2cv(camera.to_raster, to_raster);
  const auto turn = [&](const cv::Mat& from, cv::InterpolationFlags how) {
    cv::Mat turned;
    cv::warpPerspective(from,
                        turned,
                        to_raster,
                        {camera.width, camera.height},
                        how | cv::WARP_INVERSE_MAP);
    return turned;
  };
  cv::Mat slopes;
  cv::sepFilter2D(turn(raster, cv::INTER_LINEAR),
                  slopes,
                  CV_32F,
                  cv::Matx<float, 1, 5>(-1, -2, 0, 2, 1) * (1.f / 8.f),
                  cv::Matx<float, 1, 5>(1, 2, 3, 2, 1) * (1.f / 9.f));
  cv::erode(turn(validity, cv::INTER_NEAREST),
            validity,
            cv::Mat::ones(5, 5, CV_8U),
            {-1, -1},
            1,
            cv::BORDER_CONSTANT,
            0);
  std::vector<float> strengths(camera.width);
  for (int row = 0; row < camera.height; ++row) {
    for (int x = 0; x < camera.width; ++x) {
      const auto& slope = slopes.at<cv::Vec3f>(row, x);
      strengths[x] = validity.at<uint8_t>(row, x) != 0
                         ? std::sqrt(slope.dot(slope) / 3.f)
                         : 0.f;
    }
    for (int x = 1; x + 1 < camera.width; ++x) {
      const float before = strengths[x - 1];
      const float peak = strengths[x];
      const float after = strengths[x + 1];
      if (peak > kMinSlope && peak >= before && peak > after) {
        const float bend = before + after - 2.f * peak;
        edges[row].push_back(
            {static_cast<float>(x) + 0.5f * (before - after) / bend, peak});
      }
    }
  }
  return edges;
}

// Two straight edges parallel to the axis with nothing as strong between them:
// perhaps the outlines of a column or a pipe.
struct OutlinePair {
  float left = 0.f;  // Columns.
  float right = 0.f;
  int first_row = 0;
  int last_row = 0;
  size_t num_rows = 0;  // With both edges.
};

struct RowPair {
  int row;
  float left;
  float right;
};

// The pair of edges that most of these pairs of single rows are part of.
OutlinePair Join(const std::vector<RowPair>& pairs) {
  const auto median = [&](float RowPair::*column) {
    std::vector<float> values;
    for (const RowPair& pair : pairs) {
      values.push_back(pair.*column);
    }
    return UpperMedian(&values);
  };
  const float left = median(&RowPair::left);
  const float right = median(&RowPair::right);
  std::set<int> rows;
  double sums[2] = {};
  int count = 0;
  for (const RowPair& pair : pairs) {
    if (std::abs(pair.left - left) <= kTolerance &&
        std::abs(pair.right - right) <= kTolerance) {
      rows.insert(pair.row);
      sums[0] += pair.left;
      sums[1] += pair.right;
      ++count;
    }
  }
  if (rows.empty()) {
    return {};
  }
  return {static_cast<float>(sums[0] / count),
          static_cast<float>(sums[1] / count),
          *rows.begin(),
          *rows.rbegin(),
          rows.size()};
}

// Of pairs that share edges, those with the most rows take precedence.
std::vector<OutlinePair> FindOutlinePairs(
    const std::vector<std::vector<Edge>>& edges) {
  using Bin = std::pair<int, int>;  // Of two pixels.
  std::map<Bin, std::vector<RowPair>> bins;
  for (size_t row = 0; row < edges.size(); ++row) {
    const std::vector<Edge>& of_row = edges[row];
    for (size_t i = 0; i < of_row.size(); ++i) {
      const auto [left, strength] = of_row[i];
      float between = 0.f;  // The strongest edge.
      for (size_t j = i + 1;
           j < of_row.size() && between < kMaxBetween * strength &&
           of_row[j].column - left <= kMaxWidth;
           ++j) {
        const float right = of_row[j].column;
        if (right - left >= kMinWidth &&
            between < kMaxBetween * of_row[j].strength) {
          bins[{std::lround(left / 2.f), std::lround(right / 2.f)}].push_back(
              {static_cast<int>(row), left, right});
        }
        between = std::max(between, of_row[j].strength);
      }
    }
  }
  std::vector<std::pair<size_t, Bin>> by_size;
  for (const auto& [bin, pairs] : bins) {
    by_size.emplace_back(pairs.size(), bin);
  }
  std::ranges::stable_sort(
      by_size, std::greater{}, &std::pair<size_t, Bin>::first);
  std::vector<OutlinePair> result;
  for (const auto& [size, bin] : by_size) {
    // A pair between bins is spread over up to four of them; others are part of
    // another pair.
    if (4 * size < kMinRows || !bins.contains(bin)) {
      continue;
    }
    std::vector<RowPair> around;
    for (int left = bin.first - 1; left <= bin.first + 1; ++left) {
      for (int right = bin.second - 1; right <= bin.second + 1; ++right) {
        if (const auto found = bins.extract({left, right})) {
          std::ranges::copy(found.mapped(), std::back_inserter(around));
        }
      }
    }
    if (const OutlinePair pair = Join(around); pair.num_rows >= kMinRows) {
      result.push_back(pair);
    }
  }
  return result;
}

// The cross section of a cylinder.
struct Circle {
  Eigen::Vector2d center;
  double radius;
};

// The outlines of a circle in a camera.
struct Outline {
  double left;  // Columns.
  double right;
  // The mean distance, along the camera's forward direction, of the points at
  // which their rays touch the circle.
  double distance;
};

// Nothing where the camera is in the circle or close to it, or the circle is
// not in front of the camera.
std::optional<Outline> OutlineOf(const Circle& circle,
                                 const AxisCamera& camera) {
  constexpr double kMinDistance = 1.2;  // In radii.
  constexpr double kMinCosine = 0.3;    // From the forward direction.
  const Eigen::Vector2d to_center = circle.center - camera.center;
  const double distance = to_center.norm();
  if (!(distance > kMinDistance * circle.radius)) {
    return std::nullopt;
  }
  const double length =
      std::sqrt(distance * distance - circle.radius * circle.radius);
  const Eigen::Vector2d aside(-to_center.y(), to_center.x());  // Right.
  Outline outline{};
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector2d tangent =
        (to_center * length + side * circle.radius * aside) /
        (distance * distance);
    const double forward = tangent.dot(camera.forward);
    if (!(forward > kMinCosine * tangent.norm())) {
      return std::nullopt;
    }
    (side < 0.0 ? outline.left : outline.right) =
        camera.cx + camera.focal * tangent.dot(camera.right) / forward;
    outline.distance += 0.5 * forward * length;
  }
  return outline;
}

// A view that shows both outlines of a circle.
struct Support {
  const AxisCamera* camera;
  const OutlinePair* pair;
};
using Supports = std::vector<Support>;

struct CircleFit {
  Circle circle;
  double residual;             // Root mean square, in pixels.
  Eigen::Matrix3d covariance;  // Of center and radius.
  bool is_round;  // Two fixed lines explain the outlines much worse.
};

// Fits a circle to outlines by least squares of its distances from their rays,
// in pixels at a circle nearby if there is one.
std::optional<CircleFit> FitCircle(const Supports& supports,
                                   const Circle* near) {
  const auto count = static_cast<Eigen::Index>(supports.size());
  const Eigen::Vector2d origin = supports.front().camera->center;
  // Of the left outlines, then of the right ones.
  Eigen::MatrixX3d rows(2 * count, 3);
  Eigen::VectorXd values(2 * count);
  for (Eigen::Index i = 0; i < 2 * count; ++i) {
    const auto& [camera, pair] = supports[i % count];
    const double weight =
        near != nullptr ? 1.0 / camera->PixelAt(near->center) : 1.0;
    const Eigen::Vector2d ray =
        camera->Direction(i < count ? pair->left : pair->right).normalized();
    const Eigen::Vector2d normal(-ray.y(), ray.x());  // To the right.
    rows.row(i) << normal.transpose(), i < count ? -1.0 : 1.0;
    rows.row(i) *= weight;
    values[i] = weight * normal.dot(camera->center - origin);
  }
  const Eigen::Vector3d solution = rows.colPivHouseholderQr().solve(values);
  if (!solution.allFinite() || !(solution.z() > 0.0)) {
    return std::nullopt;
  }
  double squares = (rows * solution - values).squaredNorm();
  CircleFit fit;
  fit.circle = {origin + solution.head<2>(), solution.z()};
  fit.residual = std::sqrt(squares / (2.0 * count));
  const double error = std::max(fit.residual, kLeastResidual);
  fit.covariance = error * error * (rows.transpose() * rows).inverse();
  squares = 0.0;
  for (const Eigen::Index begin : {Eigen::Index{0}, count}) {
    const Eigen::MatrixX2d side = rows.middleRows(begin, count).leftCols<2>();
    const Eigen::VectorXd of_side = values.segment(begin, count);
    squares += (side * side.colPivHouseholderQr().solve(of_side) - of_side)
                   .squaredNorm();
  }
  fit.is_round = std::sqrt(squares / (2.0 * count)) >= kMinRatio * error;
  return fit;
}

// The outline pairs of a view.
struct OutlineView {
  AxisCamera camera;
  std::vector<OutlinePair> pairs;
};

// A rough test of whether two pairs may show the same circle: the radii that
// follow from their widths, where the rays through their middles meet, are
// similar.
bool MayShowOneCircle(const Support& a, const Support& b) {
  // Outlines of narrow objects are known to a tenth of the width.
  constexpr double kMaxGap = 0.4;
  const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
    return u.x() * v.y() - u.y() * v.x();
  };
  const auto middle = [](const Support& support) {
    return support.camera->Direction(
        0.5 * (support.pair->left + support.pair->right));
  };
  const auto radius = [](const Support& support, double distance) {
    return distance * (support.pair->right - support.pair->left) /
           support.camera->focal;
  };
  const Eigen::Vector2d ray_a = middle(a);
  const Eigen::Vector2d ray_b = middle(b);
  const Eigen::Vector2d between = b.camera->center - a.camera->center;
  const double area = cross(ray_a, ray_b);
  const double radius_a =
      radius(a, cross(between, ray_b) / area) / ray_a.norm();
  const double radius_b =
      radius(b, cross(between, ray_a) / area) / ray_b.norm();
  return radius_a > 0.0 && radius_b > 0.0 &&
         std::abs(radius_a - radius_b) <=
             kMaxGap * std::max(radius_a, radius_b);
}

struct Candidate {
  ModelCylinder cylinder;
  size_t num_views = 0;  // That show it,
  size_t num_rows = 0;   // and in how many rows.
};

class CylinderFinder {
 public:
  CylinderFinder(const std::vector<OutlineView>& views,
                 const std::vector<std::vector<size_t>>& neighbors,
                 const AxisFrame& frame)
      : views_(views), neighbors_(neighbors), frame_(frame) {}

  // Those that most views show come first.
  std::vector<Candidate> Find(ThreadPool& threads) const {
    std::vector<std::vector<Candidate>> of_views(views_.size());
    threads.ForEach(of_views.size(), [&](size_t i) {
      for (const size_t j : neighbors_[i]) {
        if (j > i) {
          FindInTwo(i, j, &of_views[i]);
        }
      }
    });
    std::vector<Candidate> candidates;
    std::ranges::copy(of_views | std::views::join,
                      std::back_inserter(candidates));
    std::ranges::stable_sort(
        candidates, std::greater{}, [](const Candidate& candidate) {
          return std::pair(candidate.num_views, candidate.num_rows);
        });
    return candidates;
  }

 private:
  // Adds cylinders that two views may show and that enough of these views and
  // their neighbors do.
  void FindInTwo(size_t first,
                 size_t second,
                 std::vector<Candidate>* candidates) const {
    std::set<size_t> around = {first, second};
    for (const size_t view : {first, second}) {
      around.insert(neighbors_[view].begin(), neighbors_[view].end());
    }
    for (const OutlinePair& a : views_[first].pairs) {
      for (const OutlinePair& b : views_[second].pairs) {
        const Supports two = {{&views_[first].camera, &a},
                              {&views_[second].camera, &b}};
        const auto fit = MayShowOneCircle(two[0], two[1])
                             ? FitCircle(two, nullptr)
                             : std::nullopt;
        const auto candidate = fit ? Fit(fit->circle, around) : std::nullopt;
        if (candidate) {
          candidates->push_back(*candidate);
        }
      }
    }
  }

  // A circle fitted to all of these views that show it.
  std::optional<Candidate> Fit(Circle circle,
                               const std::set<size_t>& around) const {
    Supports supports;
    std::optional<CircleFit> fit;
    for (int round = 0; round < kFitRounds; ++round) {
      supports = FindSupports(circle, around);
      fit = supports.size() < kMinViews ? std::nullopt
                                        : FitCircle(supports, &circle);
      if (!fit) {
        return std::nullopt;
      }
      circle = fit->circle;
    }
    Candidate candidate;
    std::vector<double> widths;
    std::vector<double> lows;
    std::vector<double> highs;
    double pixel = 0.0;  // The largest.
    for (const auto& [camera, pair] : supports) {
      const std::optional<Outline> outline = OutlineOf(circle, *camera);
      if (!outline) {
        return std::nullopt;
      }
      lows.push_back(camera->Height(pair->first_row, outline->distance));
      highs.push_back(-camera->Height(pair->last_row, outline->distance));
      widths.push_back(pair->right - pair->left);
      pixel = std::max(pixel, outline->distance / camera->focal);
      ++candidate.num_views;
      candidate.num_rows += pair->num_rows;
    }
    ModelCylinder& cylinder = candidate.cylinder;
    cylinder.frame = frame_;
    cylinder.point =
        circle.center.x() * frame_.across + circle.center.y() * frame_.Third();
    cylinder.radius = circle.radius;
    // What at least half of the views show.
    cylinder.min_height = UpperMedian(&lows);
    cylinder.max_height = -UpperMedian(&highs);
    cylinder.covariance = fit->covariance;
    const bool is_good =
        fit->residual <= kMaxResidual && fit->is_round &&
        UpperMedian(&widths) >= kMinMedianWidth &&
        cylinder.max_height - cylinder.min_height >= kMinLength * pixel;
    return is_good ? std::optional(candidate) : std::nullopt;
  }

  // In each view the pair with the most rows that agrees with the circle.
  Supports FindSupports(const Circle& circle,
                        const std::set<size_t>& views) const {
    Supports supports;
    for (const size_t view : views) {
      const AxisCamera& camera = views_[view].camera;
      const std::optional<Outline> outline = OutlineOf(circle, camera);
      const OutlinePair* best = nullptr;
      for (const OutlinePair& pair : views_[view].pairs) {
        if (outline && std::abs(pair.left - outline->left) <= kMaxDifference &&
            std::abs(pair.right - outline->right) <= kMaxDifference &&
            (best == nullptr || pair.num_rows > best->num_rows)) {
          best = &pair;
        }
      }
      if (best != nullptr) {
        supports.push_back({&camera, best});
      }
    }
    return supports;
  }

  const std::vector<OutlineView>& views_;
  const std::vector<std::vector<size_t>>& neighbors_;
  AxisFrame frame_;
};

// Evidence of views about a cylinder, in pixels of rasters. Counts are
// integers, so that sums do not depend on the order of views.
struct CylinderEvidence {
  int64_t area = 0;     // Of its front, without measurements before it.
  int64_t through = 0;  // Of these, with measurements behind it,
  // and of these, with a measured plane of the scene off the cylinder.
  int64_t on_planes = 0;

  // Whether measurements behind it, or planes off it, cover more than a quarter
  // of its area; single wrong depths do not.
  bool IsContradicted() const {
    return 4 * through > area || 4 * on_planes > area;
  }
};

CylinderEvidence TestCylinder(const ObservedView& view,
                              const std::vector<ModelPlane>& planes,
                              const ViewLabels& labels,
                              const CameraCylinder& cylinder) {
  const ViewEvidence& evidence = *view.evidence;
  const Intrinsics intrinsics = view.camera.GetIntrinsics();
  CylinderEvidence result;
  for (int y = 0; y < evidence.height; ++y) {
    for (int x = 0; x < evidence.width; ++x) {
      const Vec3f ray = intrinsics.Ray(x, y);
      CameraCylinder::Intersection at;
      if (!cylinder.Intersect(ray, &at) ||
          !CameraCylinder::FacesCamera(at.normal, ray)) {
        continue;
      }
      const float gap =
          kMinGap * at.depth * evidence.resolution.RelativeDepthError(at.depth);
      const float measured = evidence.confident_depth(x, y);
      if (measured > 0.f && measured < at.depth - gap) {
        continue;
      }
      ++result.area;
      result.through += measured > at.depth + gap ? 1 : 0;
      const size_t superpixel = evidence.superpixels(x, y);
      const int label = labels.planes[superpixel];
      if (label >= 0 && labels.origins[superpixel] == LabelOrigin::kMeasured) {
        const float depth =
            ToCameraPlane(planes[label].plane, view.camera).Depth(ray);
        result.on_planes += std::abs(depth - at.depth) > gap ? 1 : 0;
      }
    }
  }
  return result;
}

}  // namespace

struct CylinderSearch::Axis {
  AxisFrame frame;
  std::vector<OutlineView> outlines;  // By view.
  std::vector<ModelCylinder> cylinders;
  std::vector<CylinderEvidence> evidence;  // By cylinder.
};

std::vector<CameraCylinder> ToCameraCylinders(
    const std::vector<ModelCylinder>& cylinders, const Camera& camera) {
  std::vector<CameraCylinder> result;
  for (const ModelCylinder& cylinder : cylinders) {
    const auto turned = [&](const Eigen::Vector3d& direction) {
      return ToVec3f(camera.rotation * direction);
    };
    const Eigen::Vector3d begin =
        cylinder.point + cylinder.min_height * cylinder.frame.along;
    result.push_back(
        {ToVec3f(camera.rotation * begin + camera.translation),
         turned(cylinder.frame.along),
         static_cast<float>(cylinder.radius),
         static_cast<float>(cylinder.max_height - cylinder.min_height),
         turned(cylinder.frame.across),
         turned(cylinder.frame.Third()),
         {ToVec3f(cylinder.covariance.col(0)),
          ToVec3f(cylinder.covariance.col(1)),
          ToVec3f(cylinder.covariance.col(2))}});
  }
  return result;
}

CylinderSearch::CylinderSearch(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbors)
    : neighbors_(neighbors) {
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      axes_.push_back({{frame.col(axis), frame.col((axis + 1) % 3)},
                       std::vector<OutlineView>(neighbors.size()),
                       {},
                       {}});
    }
  }
}

CylinderSearch::~CylinderSearch() = default;

size_t CylinderSearch::NumAxes() const { return axes_.size(); }

void CylinderSearch::FindOutlines(size_t view, const ObservedView& observed) {
  for (Axis& axis : axes_) {
    if (const auto camera = MakeAxisCamera(observed.camera, axis.frame)) {
      axis.outlines[view] = {
          *camera,
          FindOutlinePairs(FindEdges(observed.evidence->color, *camera))};
    }
  }
}

void CylinderSearch::FindCircles(size_t index, ThreadPool& threads) {
  Axis& axis = axes_[index];
  for (const Candidate& candidate :
       CylinderFinder(axis.outlines, neighbors_, axis.frame).Find(threads)) {
    const ModelCylinder& cylinder = candidate.cylinder;
    // Not what intersects another one, or is inside, at the same heights.
    const double tolerance = 0.2 * (cylinder.max_height - cylinder.min_height);
    const bool is_taken =
        std::ranges::any_of(axis.cylinders, [&](const ModelCylinder& other) {
          return axis.frame.Across(cylinder.point - other.point).norm() <
                     cylinder.radius + other.radius &&
                 cylinder.min_height < other.max_height - tolerance &&
                 other.min_height < cylinder.max_height - tolerance;
        });
    if (!is_taken) {
      axis.cylinders.push_back(cylinder);
    }
  }
  axis.evidence.resize(axis.cylinders.size());
  axis.outlines = {};
}

bool CylinderSearch::HasFoundAny() const {
  return std::ranges::any_of(
      axes_, [](const Axis& axis) { return !axis.cylinders.empty(); });
}

void CylinderSearch::Test(const ObservedView& observed,
                          const std::vector<ModelPlane>& planes,
                          const ViewLabels& labels) {
  for (Axis& axis : axes_) {
    const std::vector<CameraCylinder> cylinders =
        ToCameraCylinders(axis.cylinders, observed.camera);
    for (size_t k = 0; k < cylinders.size(); ++k) {
      const CylinderEvidence of_view =
          TestCylinder(observed, planes, labels, cylinders[k]);
      const std::lock_guard lock(mutex_);
      axis.evidence[k].area += of_view.area;
      axis.evidence[k].through += of_view.through;
      axis.evidence[k].on_planes += of_view.on_planes;
    }
  }
}

std::vector<ModelCylinder> CylinderSearch::Result() const {
  std::vector<ModelCylinder> result;
  for (const Axis& axis : axes_) {
    for (size_t k = 0; k < axis.cylinders.size(); ++k) {
      if (!axis.evidence[k].IsContradicted()) {
        result.push_back(axis.cylinders[k]);
      }
    }
  }
  return result;
}

}  // namespace tsar
