// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_checks.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/median.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/map_conventions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kMaxDegrees = 1.0;
constexpr double kMaxShareOfExtent = 0.01;
constexpr double kMaxRatio = 0.02;

// The diagonal of the bounding box of all camera centers.
double Extent(const SparseModel& model) {
  Eigen::AlignedBox3d box;
  for (const SparseModel::ModelImage& image : model.images) {
    box.extend(image.camera.Center());
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

// The difference of two poses, each component as a share of its tolerance.
struct PoseError {
  double rotation = 0.0;
  double center = 0.0;

  bool Fits() const { return rotation <= 1.0 && center <= 1.0; }
  double Sum() const { return rotation + center; }
};

Error OtherCamera(const StoredCamera& stored,
                  const std::string& what,
                  const std::string& advice) {
  return Error::File(ErrorCode::kMismatch, stored.file, what, advice);
}

// extent: that of the model.
void CheckPose(const AssignedCamera& assigned,
               const SparseModel& model,
               double extent,
               double scale) {
  const StoredCamera& stored = assigned.camera;
  const auto error_of = [&](const SparseModel::ModelImage& image) {
    const Camera& camera = image.camera;
    const double cosine =
        ((stored.rotation * camera.rotation.transpose()).trace() - 1.0) / 2.0;
    PoseError error;
    error.rotation =
        std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / M_PI / kMaxDegrees;
    // A single center has no extent to compare with.
    if (extent > 0.0) {
      error.center = (scale * stored.center - camera.Center()).norm() /
                     (kMaxShareOfExtent * extent);
    }
    return error;
  };
  // The tolerance of rounding in text files.
  constexpr double kExact = 0.2;
  const SparseModel::ModelImage& image = model.images[assigned.image];
  const PoseError own = error_of(image);
  if (own.Sum() <= kExact) {
    return;
  }
  const SparseModel::ModelImage& best =
      *std::ranges::min_element(model.images, {}, [&](const auto& other) {
        return error_of(other).Sum();
      });
  const PoseError smallest = error_of(best);
  if (own.Fits() && smallest.Sum() >= 0.1 * own.Sum()) {
    return;
  }
  if (&best != &image && smallest.Fits()) {
    throw OtherCamera(
        stored,
        "is the camera of " + best.name + ", not of " + image.name +
            ": the images are in another order",
        "name the images in their order with " + OptionName("image_list"));
  }
  throw OtherCamera(
      stored,
      "the camera is not that of " + image.name + ", it differs by " +
          Formatted("%.2f degrees and %.3g of the scene's extent",
                    own.rotation * kMaxDegrees,
                    own.center * kMaxShareOfExtent),
      "use maps that were made from this sparse model; for maps in other "
      "units give " +
          OptionName("depth_scale"));
}

void CheckIntrinsics(const AssignedCamera& assigned, const SparseModel& model) {
  const SparseModel::ModelImage& image = model.images[assigned.image];
  const Camera& camera = image.camera;
  const StoredCamera& stored = assigned.camera;
  const double x = stored.cx / stored.fx;
  const double y = stored.cy / stored.fy;
  const double own_x = camera.cx / camera.fx;
  const double own_y = camera.cy / camera.fy;
  const double difference =
      std::max({std::abs(stored.fx / stored.fy * camera.fy / camera.fx - 1.0),
                std::abs(x - own_x),
                std::abs(y - own_y)});
  if (difference > kMaxRatio) {
    throw OtherCamera(stored,
                      "the camera is not that of " + image.name +
                          ": its principal point over its focal length is " +
                          Formatted("%.4g and %.4g, the image's ", x, y) +
                          Formatted("%.4g and %.4g", own_x, own_y),
                      "use maps of the undistorted images of this workspace");
  }
}

}  // namespace

void CheckCameras(const std::vector<AssignedCamera>& cameras,
                  const SparseModel& model,
                  double scale) {
  const double extent = Extent(model);
  for (const AssignedCamera& assigned : cameras) {
    CheckPose(assigned, model, extent, scale);
  }
  for (const AssignedCamera& assigned : cameras) {
    CheckIntrinsics(assigned, model);
  }
}

SparseComparison CompareWithSparse(const SparseModel& model,
                                   int image,
                                   const Image<float>& depth) {
  std::vector<double> ratios;
  ForEachSparsePoint(
      model, image, depth.Width(), depth.Height(), [&](int x, int y, double z) {
        if (depth(x, y) > 0.f) {
          ratios.push_back(depth(x, y) / z);
        }
      });
  SparseComparison comparison;
  comparison.num_points = static_cast<int>(ratios.size());
  if (!ratios.empty()) {
    comparison.ratio = UpperMedian(&ratios);
  }
  return comparison;
}

ScaleVerdict JudgeScale(const std::vector<SparseComparison>& comparisons) {
  constexpr double kMaxDeviation = 0.1;
  constexpr double kMinShare = 0.8;
  std::vector<double> ratios;
  for (const SparseComparison& comparison : comparisons) {
    if (comparison.num_points >= kMinSparsePoints) {
      ratios.push_back(comparison.ratio);
    }
  }
  ScaleVerdict verdict;
  if (ratios.empty()) {
    return verdict;
  }
  verdict.num_images = static_cast<int>(ratios.size());
  verdict.median = UpperMedian(&ratios);
  verdict.smallest = *std::ranges::min_element(ratios);
  verdict.largest = *std::ranges::max_element(ratios);
  const auto num_near = std::ranges::count_if(ratios, [&](double ratio) {
    return std::abs(ratio - verdict.median) <= kMaxDeviation * verdict.median;
  });
  verdict.is_consistent = static_cast<double>(num_near) >=
                          kMinShare * static_cast<double>(ratios.size());
  return verdict;
}

bool IsOffScale(double ratio) {
  constexpr double kMax = 1.2;
  return ratio > kMax || ratio < 1.0 / kMax;
}

}  // namespace tsar
