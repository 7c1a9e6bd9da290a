// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_conventions.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"

#include <algorithm>
#include <iterator>

namespace tsar {
namespace {

// How far a number that stands for "no depth" lies beyond depths, as a factor;
// and beyond all depths of an image without sparse points.
constexpr double kMinGap = 1.5;
constexpr double kMinGapWithoutPoints = 100.0;
constexpr int kMinPoints = 5;

// The depth that is to be expected where the map has `extreme`, in its units:
// by the sparse points there or, if there are few, by the farthest of all, or
// the nearest if `is_far` is false. 0 without points.
double ExpectedDepth(const MapSample& sample,
                     const SparseModel& model,
                     int image,
                     float extreme,
                     bool is_far) {
  std::vector<double> all;
  std::vector<double> there;
  std::vector<double> ratios;  // Of the other depths.
  ForEachSparsePoint(model,
                     image,
                     sample.depth.Width(),
                     sample.height,
                     [&](int x, int y, double z) {
                       all.push_back(is_far ? z : -z);
                       const auto row =
                           std::ranges::lower_bound(sample.rows, y);
                       if (row == sample.rows.end() || *row != y) {
                         return;
                       }
                       const float depth = sample.depth(
                           x, static_cast<int>(row - sample.rows.begin()));
                       if (depth == extreme) {
                         there.push_back(z);
                       } else if (depth > 0.f) {
                         ratios.push_back(depth / z);
                       }
                     });
  if (all.size() < kMinPoints) {
    return 0.0;
  }
  const double unit = ratios.size() < kMinPoints ? 1.0 : UpperMedian(&ratios);
  if (there.size() >= kMinPoints) {
    return unit * UpperMedian(&there);
  }
  // Some points are wrong.
  const auto last = all.end() - 1 - std::ssize(all) / 50;
  std::nth_element(all.begin(), last, all.end());
  return unit * std::abs(*last);
}

bool IsNoDepth(const std::vector<float>& depths,
               const MapSample& sample,
               const SparseModel* model,
               int image,
               float extreme,
               bool is_far) {
  constexpr size_t kMinShare = 100;  // One of so many.
  constexpr size_t kMaxNear = 10;
  size_t num_same = 0;
  size_t num_near = 0;
  double gap = 1e300;  // To the nearest of the others.
  for (const float depth : depths) {
    const double factor =
        is_far ? double{extreme} / depth : depth / double{extreme};
    num_same += factor == 1.0 ? 1 : 0;
    num_near += factor > 1.0 && factor < kMinGap ? 1 : 0;
    gap = factor > 1.0 ? std::min(gap, factor) : gap;
  }
  if (num_same * kMinShare < depths.size() || num_near * kMaxNear > num_same) {
    return false;
  }
  const double expected =
      model == nullptr ? 0.0
                       : ExpectedDepth(sample, *model, image, extreme, is_far);
  if (expected == 0.0) {
    return num_same < depths.size() && gap > kMinGapWithoutPoints;
  }
  const double factor = is_far ? extreme / expected : expected / extreme;
  return factor > (num_same < depths.size() ? kMinGap : kMinGapWithoutPoints);
}

}  // namespace

MapSample::MapSample(int width, int map_height) : height(map_height) {
  constexpr int kNumPairs = 16;
  const int num_apart = std::max(1, height / (4 * kNumPairs));
  for (int i = 0; i < kNumPairs; ++i) {
    const int row = (2 * i + 1) * height / (2 * kNumPairs);
    if (row + num_apart < height && (rows.empty() || row > rows.back())) {
      rows.insert(rows.end(), {row, row + num_apart});
    }
  }
  depth = Image<float>(width, static_cast<int>(rows.size()));
  normal = Image<Vec3f>(width, static_cast<int>(rows.size()));
}

MapSample::MapSample(const Image<float>& whole_depth,
                     const Image<Vec3f>& whole_normal)
    : MapSample(whole_depth.Width(), whole_depth.Height()) {
  for (int i = 0; i < depth.Height(); ++i) {
    std::copy_n(&whole_depth(0, rows[i]), depth.Width(), &depth(0, i));
    if (!whole_normal.Empty()) {
      std::copy_n(&whole_normal(0, rows[i]), depth.Width(), &normal(0, i));
    }
  }
}

float FindNoDepth(const MapSample& sample,
                  const SparseModel* model,
                  int image) {
  std::vector<float> depths;
  std::ranges::copy_if(sample.depth,
                       std::back_inserter(depths),
                       [](float depth) { return depth > 0.f; });
  if (depths.empty()) {
    return 0.f;
  }
  const auto [smallest, largest] = std::ranges::minmax(depths);
  for (const bool is_far : {true, false}) {
    const float extreme = is_far ? largest : smallest;
    if (IsNoDepth(depths, sample, model, image, extreme, is_far)) {
      return extreme;
    }
  }
  return 0.f;
}

void ClearNoDepth(float no_depth, std::span<float> depths) {
  if (no_depth != 0.f) {
    std::ranges::replace(depths, no_depth, 0.f);
  }
}

Eigen::Matrix3d ToCameraFrame(NormalFrame frame, const Camera& camera) {
  switch (frame) {
    case NormalFrame::kCamera:
      return Eigen::Matrix3d::Identity();
    case NormalFrame::kOpenGl:
      return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    case NormalFrame::kWorld:
      break;
  }
  return camera.rotation;
}

void NormalEvidence::Add(const MapSample& sample, const Camera& camera) {
  constexpr float kMaxJump = 0.1f;
  constexpr double kMaxCosine = 0.25;
  const Image<float>& depth = sample.depth;
  const Intrinsics intrinsics =
      camera.Resized(depth.Width(), sample.height).GetIntrinsics();
  std::array<Eigen::Matrix3d, kNumFrames> turns;
  for (size_t i = 0; i < kNumFrames; ++i) {
    turns[i] = ToCameraFrame(static_cast<NormalFrame>(i), camera);
  }
  const auto point_at = [&](int x, int row) {
    const Vec3f point =
        depth(x, row) * intrinsics.Ray(static_cast<float>(x),
                                       static_cast<float>(sample.rows[row]));
    return Eigen::Vector3d(point.x, point.y, point.z);
  };
  for (int row = 0; row < depth.Height(); ++row) {
    // Each odd row is the lower one of a pair.
    const bool is_upper = row % 2 == 0;
    const int num_apart = sample.rows[row | 1] - sample.rows[row & ~1];
    for (int x = 0; x < depth.Width(); ++x) {
      const float here = depth(x, row);
      const Vec3f& stored = sample.normal(x, row);
      num_depths_ += here > 0.f ? 1 : 0;
      if (!(here > 0.f) || !(Norm(stored) > 0.f)) {
        continue;
      }
      const Eigen::Vector3d normal =
          Eigen::Vector3d(stored.x, stored.y, stored.z).normalized();
      const Eigen::Vector3d point = point_at(x, row);
      const auto is_near = [&](int other_x, int other_row) {
        return depth.Contains(other_x, other_row) &&
               std::abs(depth(other_x, other_row) - here) < kMaxJump * here;
      };
      const bool has_surface =
          is_upper && is_near(x + num_apart, row) && is_near(x, row + 1);
      ++num_normals_;
      num_surfaces_ += has_surface ? 1 : 0;
      std::array<Eigen::Vector3d, 2> along;  // The surface.
      if (has_surface) {
        along = {(point_at(x + num_apart, row) - point).normalized(),
                 (point_at(x, row + 1) - point).normalized()};
      }
      for (size_t i = 0; i < kNumFrames; ++i) {
        const Eigen::Vector3d turned = turns[i] * normal;
        num_facing_[i] += turned.dot(point) < 0.0 ? 1 : 0;
        const auto lies_along = [&](const Eigen::Vector3d& side) {
          return std::abs(turned.dot(side)) < kMaxCosine;
        };
        num_upright_[i] +=
            has_surface && std::ranges::all_of(along, lies_along) ? 1 : 0;
      }
    }
  }
}

NormalVerdict NormalEvidence::Judge(NormalFrame usual) const {
  constexpr int64_t kMinPercent = 5;
  constexpr int64_t kMinSurfaces = 200;
  constexpr int64_t kMinUprightPercent = 8;
  const auto num_agreeing = [&](size_t i) {
    return std::max(num_facing_[i], num_normals_ - num_facing_[i]);
  };
  auto best = static_cast<size_t>(usual);
  for (size_t i = 0; i < kNumFrames; ++i) {
    const int64_t num_more = num_agreeing(i) - num_agreeing(best);
    const int64_t num_more_upright = num_upright_[i] - num_upright_[best];
    if (num_more * 100 > kMinPercent * num_normals_ ||
        (num_more >= 0 &&
         num_more_upright * 100 > 2 * kMinPercent * num_surfaces_)) {
      best = i;
    }
  }
  NormalVerdict verdict = {
      static_cast<NormalFrame>(best), 2 * num_facing_[best] < num_normals_, ""};
  constexpr const char* kAdvice =
      "; write unit vectors in the camera's frame, x right, y down, z forward, "
      "that point from the surfaces towards the camera";
  const std::string what =
      verdict.frame == NormalFrame::kOpenGl  ? "are in the frame of OpenGL"
      : verdict.frame == NormalFrame::kWorld ? "are in the frame of the world"
      : verdict.frame != usual
          ? "are in the frame of the camera, not the world,"
          : "point away from the camera";
  const bool is_other =
      verdict.frame != usual ||
      (verdict.frame == NormalFrame::kCamera && verdict.face_away);
  if (is_other) {
    verdict.remark = "the normals " + what + " and are read so";
  }
  if (num_depths_ > 0 && num_normals_ == 0) {
    verdict.remark = std::string("no depth has a normal") + kAdvice;
  } else if (num_surfaces_ >= kMinSurfaces &&
             num_upright_[best] * 100 < kMinUprightPercent * num_surfaces_) {
    verdict.remark =
        (is_other ? verdict.remark + ", and " : std::string("the normals ")) +
        "contradict the depths" + kAdvice;
  }
  return verdict;
}

void MapConventions::Apply(std::span<Vec3f> normals) const {
  if (turn.isIdentity()) {
    return;
  }
  for (Vec3f& normal : normals) {
    normal = ToVec3f(turn * Eigen::Vector3d(normal.x, normal.y, normal.z));
  }
}

MapConventions FindConventions(const MapSample& sample,
                               const SparseModel& model,
                               int image) {
  MapConventions conventions;
  conventions.no_depth = FindNoDepth(sample, &model, image);
  if (conventions.no_depth != 0.f) {
    conventions.remarks.push_back(NoDepthRemark(conventions.no_depth));
  }
  MapSample rest = sample;
  ClearNoDepth(conventions.no_depth, rest.depth);
  const Camera& camera = model.images[image].camera;
  NormalEvidence evidence;
  evidence.Add(rest, camera);
  const NormalVerdict verdict = evidence.Judge(NormalFrame::kCamera);
  conventions.turn =
      (verdict.face_away ? -1.0 : 1.0) * ToCameraFrame(verdict.frame, camera);
  if (!verdict.remark.empty()) {
    conventions.remarks.push_back(verdict.remark);
  }
  return conventions;
}

std::string NoDepthRemark(float no_depth) {
  return Formatted(
      "many depths are %.6g, far beyond what the scene has, and "
      "are taken for \"no depth\"",
      no_depth);
}

void ImageRemarks::Add(const std::vector<std::string>& remarks,
                       const std::string& image) {
  for (const std::string& remark : remarks) {
    images[remark].push_back(image);
  }
}

void ImageRemarks::Add(const ImageRemarks& others) {
  for (const auto& [remark, names] : others.images) {
    std::ranges::copy(names, std::back_inserter(images[remark]));
  }
}

std::vector<std::string> ImageRemarks::Lines() const {
  std::vector<std::string> lines;
  for (const auto& [remark, names] : images) {
    lines.push_back(AndMore(names.front(), names.size()) + ": " + remark);
  }
  return lines;
}

}  // namespace tsar
