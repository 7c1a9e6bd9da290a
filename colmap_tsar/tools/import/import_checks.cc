// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_checks.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kMaxDegrees = 1.0;
constexpr double kMaxShareOfExtent = 0.01;
constexpr double kMaxRatio = 0.02;

const SparseModel::ModelImage& ImageOf(const SparseModel& model, int image) {
  return model.images[image];
}

// The diagonal of the bounding box of all camera centers.
double Extent(const SparseModel& model) {
  Eigen::AlignedBox3d box;
  for (const SparseModel::ModelImage& image : model.images) {
    box.extend(image.camera.Center());
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

double Degrees(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const double cosine = ((a * b.transpose()).trace() - 1.0) / 2.0;
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / M_PI;
}

// The difference of two poses, each component as a share of its tolerance.
struct PoseError {
  double rotation = 0.0;
  double center = 0.0;

  bool Fits() const { return rotation <= 1.0 && center <= 1.0; }
  double Sum() const { return rotation + center; }
};

class CameraChecker {
 public:
  CameraChecker(const std::vector<AssignedCamera>& cameras,
                const SparseModel& model,
                double scale)
      : cameras_(cameras),
        model_(model),
        scale_(scale),
        extent_(Extent(model)) {}

  void Check() const {
    for (const AssignedCamera& assigned : cameras_) {
      if (!IsRight(assigned)) {
        throw WrongPose(assigned);
      }
    }
    for (const AssignedCamera& assigned : cameras_) {
      CheckIntrinsics(assigned);
    }
  }

 private:
  PoseError Compare(const StoredCamera& stored, int image, double scale) const {
    const Camera& camera = ImageOf(model_, image).camera;
    PoseError error;
    error.rotation = Degrees(stored.rotation, camera.rotation) / kMaxDegrees;
    const double distance = (scale * stored.center - camera.Center()).norm();
    // A single center has no extent to compare with.
    if (extent_ > 0.0) {
      error.center = distance / (kMaxShareOfExtent * extent_);
    }
    return error;
  }

  bool IsRight(const AssignedCamera& assigned) const {
    const PoseError own = Compare(assigned.camera, assigned.image, scale_);
    if (!own.Fits()) {
      return false;
    }
    // The tolerance of rounding in text files.
    constexpr double kExact = 0.2;
    return own.Sum() <= kExact ||
           Compare(assigned.camera, BestImage(assigned.camera), scale_).Sum() >=
               0.1 * own.Sum();
  }

  int BestImage(const StoredCamera& stored) const {
    int best = 0;
    double smallest = INFINITY;
    for (size_t i = 0; i < model_.images.size(); ++i) {
      const int image = static_cast<int>(i);
      const double error = Compare(stored, image, scale_).Sum();
      if (error < smallest) {
        smallest = error;
        best = image;
      }
    }
    return best;
  }

  Error WrongPose(const AssignedCamera& assigned) const {
    const std::string& name = ImageOf(model_, assigned.image).name;
    const int best = BestImage(assigned.camera);
    if (best != assigned.image &&
        Compare(assigned.camera, best, scale_).Fits()) {
      return Error::File(
          ErrorCode::kMismatch,
          assigned.camera.file,
          "is the camera of " + ImageOf(model_, best).name + ", not of " +
              name + ": the images are in another order",
          "name the images in their order with " + OptionName("image_list"));
    }
    const PoseError error = Compare(assigned.camera, assigned.image, scale_);
    char text[96];
    std::snprintf(text,
                  sizeof(text),
                  "by %.2f degrees and %.3g of the scene's extent",
                  error.rotation * kMaxDegrees,
                  error.center * kMaxShareOfExtent);
    return Error::File(
        ErrorCode::kMismatch,
        assigned.camera.file,
        "the camera is not that of " + name + ", it differs " + text,
        "use maps that were made from this sparse model; for maps in other "
        "units give " +
            OptionName("depth_scale"));
  }

  void CheckIntrinsics(const AssignedCamera& assigned) const {
    const Camera& camera = ImageOf(model_, assigned.image).camera;
    const StoredCamera& stored = assigned.camera;
    const double difference =
        std::max({std::abs(stored.fx / stored.fy * camera.fy / camera.fx - 1.0),
                  std::abs(stored.cx / stored.fx - camera.cx / camera.fx),
                  std::abs(stored.cy / stored.fy - camera.cy / camera.fy)});
    if (difference > kMaxRatio) {
      char text[96];
      std::snprintf(text,
                    sizeof(text),
                    "%.4g and %.4g, the image's %.4g and %.4g",
                    stored.cx / stored.fx,
                    stored.cy / stored.fy,
                    camera.cx / camera.fx,
                    camera.cy / camera.fy);
      throw Error::File(
          ErrorCode::kMismatch,
          stored.file,
          "the camera is not that of " + ImageOf(model_, assigned.image).name +
              ": its principal point over its focal length is " + text,
          "use maps of the undistorted images of this workspace");
    }
  }

  const std::vector<AssignedCamera>& cameras_;
  const SparseModel& model_;
  double scale_;
  double extent_;
};

// Reorders the values.
double Median(std::vector<double>* values) {
  const auto middle = values->begin() + values->size() / 2;
  std::ranges::nth_element(*values, middle);
  return *middle;
}

}  // namespace

void CheckCameras(const std::vector<AssignedCamera>& cameras,
                  const SparseModel& model,
                  double scale) {
  CameraChecker(cameras, model, scale).Check();
}

SparseComparison CompareWithSparse(const SparseModel& model,
                                   int image,
                                   const Image<float>& depth) {
  const SparseModel::ModelImage& view = model.images[image];
  const Camera camera = view.camera.Resized(depth.Width(), depth.Height());
  std::vector<double> ratios;
  for (const int index : view.point_indices) {
    const Eigen::Vector3d point =
        camera.rotation * model.points[index] + camera.translation;
    if (!(point.z() > 0.0)) {
      continue;
    }
    const double x = camera.fx * point.x() / point.z() + camera.cx;
    const double y = camera.fy * point.y() / point.z() + camera.cy;
    if (!(x > -0.5 && y > -0.5 && x < depth.Width() - 0.5 &&
          y < depth.Height() - 0.5)) {
      continue;
    }
    const float here = depth(static_cast<int>(std::lround(x)),
                             static_cast<int>(std::lround(y)));
    if (here > 0.f) {
      ratios.push_back(here / point.z());
    }
  }
  SparseComparison comparison;
  comparison.num_points = static_cast<int>(ratios.size());
  if (!ratios.empty()) {
    comparison.ratio = Median(&ratios);
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
  verdict.median = Median(&ratios);
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
