// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/align_prior.h"

#include "colmap_tsar/priors/correct_prior.h"
#include "colmap_tsar/priors/prior_type.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kMinSamples = 200;
// Priors of other images or scenes explain up to half of the standard deviation
// of depths, since in all images of rooms the floor is near. Half is enough
// where errors are small, as for facades, whose depths hardly vary.
constexpr double kMinSkill = 0.75;
constexpr double kMinSkillOfSmallSpread = 0.5;
constexpr double kSmallSpread = 0.04;
// The number of blocks along the image's long side, every second of which is
// held out to measure how well it is predicted.
constexpr int kNumBlocks = 5;
// Predictions with errors beyond this many sigmas are outliers.
constexpr double kOutlier = 3.0;
constexpr double kMinOutlierShare = 0.02;
constexpr double kMaxOutlierShare = 0.5;
// Steps of the prior make depths within this share of the image's long side
// uncertain, unless they are below kFlat. The larger share is for priors that
// are not aligned with their images: it is used if pixels without steps within
// the smaller share have more outliers, by this factor and share, than those
// without steps within the larger one.
constexpr double kEdgeWidth = 0.004;
constexpr double kLargeEdgeWidth = 0.02;
constexpr double kMoreOutliers = 2.0;
constexpr double kManyOutliers = 0.01;
constexpr float kFlat = 0.03f;
constexpr float kEdge = 0.1f;
constexpr size_t kMinEdgeSamples = 50;

bool IsMeasured(const RayDepth& sample) { return sample.z > 0.f; }

// The prior's value in a pixel of the raster: interpolated where all four
// neighbors have one, so that slanted surfaces do not become stairs.
float ValueAt(const Image<float>& values,
              const Image<RayDepth>& raster,
              int x,
              int y) {
  const float u = (x + 0.5f) * values.Width() / raster.Width() - 0.5f;
  const float v = (y + 0.5f) * values.Height() / raster.Height() - 0.5f;
  const int x0 =
      std::clamp(static_cast<int>(std::floor(u)), 0, values.Width() - 1);
  const int y0 =
      std::clamp(static_cast<int>(std::floor(v)), 0, values.Height() - 1);
  const int x1 = std::min(x0 + 1, values.Width() - 1);
  const int y1 = std::min(y0 + 1, values.Height() - 1);
  const float s = std::clamp(u - static_cast<float>(x0), 0.f, 1.f);
  const float t = std::clamp(v - static_cast<float>(y0), 0.f, 1.f);
  const float corners[] = {
      values(x0, y0), values(x1, y0), values(x0, y1), values(x1, y1)};
  if (std::all_of(std::begin(corners), std::end(corners), [](float value) {
        return value > 0.f && std::isfinite(value);
      })) {
    return (1.f - t) * ((1.f - s) * corners[0] + s * corners[1]) +
           t * ((1.f - s) * corners[2] + s * corners[3]);
  }
  const float nearest = corners[(t < 0.5f ? 0 : 2) + (s < 0.5f ? 0 : 1)];
  return nearest > 0.f && std::isfinite(nearest) ? nearest : 0.f;
}

// The largest minus the smallest value in a square window of this radius; NaN
// where the image is.
Image<float> LocalRange(const Image<float>& image, int radius) {
  const cv::Size size(2 * radius + 1, 2 * radius + 1);
  const cv::Mat window = cv::getStructuringElement(cv::MORPH_RECT, size);
  const auto extreme = [&](float instead_of_none, int operation) {
    Image<float> values = image;
    for (float& value : values) {
      value = std::isnan(value) ? instead_of_none : value;
    }
    cv::Mat matrix(values.Height(), values.Width(), CV_32F, values.Data());
    cv::morphologyEx(matrix, matrix, operation, window);
    return values;
  };
  constexpr float kFar = 1e30f;
  const Image<float> high = extreme(-kFar, cv::MORPH_DILATE);
  const Image<float> low = extreme(kFar, cv::MORPH_ERODE);
  Image<float> range(image.Width(), image.Height());
  for (size_t i = 0; i < range.NumPixels(); ++i) {
    range.Data()[i] =
        std::isnan(image.Data()[i]) ? kNone : high.Data()[i] - low.Data()[i];
  }
  return range;
}

bool IsLeftOut(int x, int y, const Image<float>& image) {
  const int side = std::max(image.Width(), image.Height());
  return (x * kNumBlocks / side + y * kNumBlocks / side) % 2 == 1;
}

// The error of the corrected prior at a measurement, and its predictors.
struct Prediction {
  double error = 0.0;
  double sigma = 0.0;
  double step = 0.0;  // The excess over kFlat of the step within reach.
};

// Predicts the measurements that were held out.
std::vector<Prediction> Predict(const Image<float>& residual,
                                const Image<float>& steps,
                                const PriorCorrection& correction) {
  std::vector<Prediction> predictions;
  for (int y = 0; y < residual.Height(); ++y) {
    for (int x = 0; x < residual.Width(); ++x) {
      if (!std::isnan(residual(x, y)) && IsLeftOut(x, y, residual)) {
        predictions.push_back({residual(x, y) - correction.offset(x, y),
                               correction.sigma(x, y),
                               std::max(steps(x, y) - kFlat, 0.f)});
      }
    }
  }
  return predictions;
}

// The size of errors at steps of the prior, as a share of the step.
double ErrorAtSteps(const std::vector<Prediction>& predictions) {
  std::vector<double> shares;
  for (const Prediction& prediction : predictions) {
    if (prediction.step > kEdge - kFlat) {
      shares.push_back(prediction.error / prediction.step);
    }
  }
  return shares.size() >= kMinEdgeSamples
             ? std::min(RobustSpread(std::move(shares)), 1.0)
             : 0.5;
}

double SigmaOf(const Prediction& prediction, double error_at_steps) {
  const double at_step = error_at_steps * prediction.step;
  return std::sqrt(prediction.sigma * prediction.sigma + at_step * at_step);
}

// The error model of a prior, estimated from prediction errors.
struct Calibration {
  double error_at_steps = 0.5;
  // The factor of sigma.
  double stretch = 1.0;
  double outlier_share = kMaxOutlierShare;
  double outlier_share_if_flat = 0.0;  // Where there is no step.
};

Calibration Calibrate(const std::vector<Prediction>& predictions) {
  Calibration calibration;
  if (predictions.empty()) {
    return calibration;
  }
  calibration.error_at_steps = ErrorAtSteps(predictions);
  std::vector<double> ratios;
  for (const Prediction& prediction : predictions) {
    ratios.push_back(prediction.error /
                     SigmaOf(prediction, calibration.error_at_steps));
  }
  calibration.stretch = std::max(1.0, RobustSpread(ratios));
  double num_outliers = 0.0;
  double num_flat = 0.0;
  double num_flat_outliers = 0.0;
  for (size_t i = 0; i < ratios.size(); ++i) {
    const double is_outlier =
        std::abs(ratios[i]) > kOutlier * calibration.stretch ? 1.0 : 0.0;
    const double is_flat = predictions[i].step > 0.0 ? 0.0 : 1.0;
    num_outliers += is_outlier;
    num_flat += is_flat;
    num_flat_outliers += is_flat * is_outlier;
  }
  calibration.outlier_share = num_outliers / static_cast<double>(ratios.size());
  calibration.outlier_share_if_flat =
      num_flat_outliers / std::max(num_flat, 1.0);
  return calibration;
}

Image<float> StepsWithin(double width, const Image<float>& log_depth) {
  const int side = std::max(log_depth.Width(), log_depth.Height());
  return LocalRange(log_depth,
                    std::max(1, static_cast<int>(std::lround(width * side))));
}

// "as inverse depth it explains 97 % of the spread of the measured depths"
std::string DescribeSkill(const PriorAssessment& assessment,
                          const std::string& only) {
  return "as " + ToString(assessment.type) + " depth it explains " + only +
         std::to_string(std::lround(100.f * assessment.skill)) +
         " % of the spread of the measured depths";
}

}  // namespace

std::string Describe(const PriorAssessment& assessment) {
  switch (assessment.verdict) {
    case PriorVerdict::kNone:
      break;
    case PriorVerdict::kUsed:
      return "depth prior used: " + DescribeSkill(assessment, "");
    case PriorVerdict::kNoDepth:
      return "depth prior not used: it has no depths";
    case PriorVerdict::kFewMeasured:
      return "depth prior not used: too few of its pixels were measured";
    case PriorVerdict::kUnlike:
      return "depth prior not used: " + DescribeSkill(assessment, "only ");
  }
  return "";
}

AlignedPrior AlignPrior(const DepthPrior& prior,
                        const Image<RayDepth>& samples) {
  AlignedPrior aligned;
  const int width = samples.Width();
  const int height = samples.Height();
  if (prior.values.Empty()) {
    aligned.assessment.verdict = PriorVerdict::kNoDepth;
    return aligned;
  }
  Image<float> values(width, height);
  std::vector<PriorSample> measured;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      values(x, y) = ValueAt(prior.values, samples, x, y);
      if (values(x, y) > 0.f && IsMeasured(samples(x, y))) {
        measured.push_back({values(x, y), samples(x, y).z});
      }
    }
  }
  if (measured.size() < kMinSamples) {
    aligned.assessment.verdict = PriorVerdict::kFewMeasured;
    return aligned;
  }
  const PriorFit fit = FitPrior(measured, prior.type);
  aligned.assessment.type = fit.function.type;
  aligned.assessment.skill = static_cast<float>(std::max(fit.Skill(), 0.0));
  if (fit.Skill() <
      (fit.spread > kSmallSpread ? kMinSkill : kMinSkillOfSmallSpread)) {
    aligned.assessment.verdict = PriorVerdict::kUnlike;
    return aligned;
  }
  aligned.assessment.verdict = PriorVerdict::kUsed;
  Image<float> log_depth(width, height, kNone);
  Image<float> residual(width, height, kNone);
  Image<float> kept(width, height, kNone);  // Without the held out.
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double depth = fit.function.Depth(values(x, y));
      if (!(depth > 0.0)) {
        continue;
      }
      log_depth(x, y) = static_cast<float>(std::log(depth));
      if (IsMeasured(samples(x, y))) {
        residual(x, y) = std::log(samples(x, y).z) - log_depth(x, y);
        kept(x, y) = IsLeftOut(x, y, residual) ? kNone : residual(x, y);
      }
    }
  }
  const PriorCorrection from_kept = CorrectPrior(log_depth, kept);
  Image<float> steps = StepsWithin(kEdgeWidth, log_depth);
  Calibration calibration = Calibrate(Predict(residual, steps, from_kept));
  Image<float> more_steps = StepsWithin(kLargeEdgeWidth, log_depth);
  const Calibration with_more =
      Calibrate(Predict(residual, more_steps, from_kept));
  if (calibration.outlier_share_if_flat >
      kMoreOutliers * with_more.outlier_share_if_flat + kManyOutliers) {
    steps = std::move(more_steps);
    calibration = with_more;
  }
  aligned.outlier_share = static_cast<float>(std::clamp(
      calibration.outlier_share, kMinOutlierShare, kMaxOutlierShare));
  const PriorCorrection correction = CorrectPrior(log_depth, residual);
  aligned.depth = Image<float>(width, height);
  aligned.sigma = Image<float>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!std::isnan(log_depth(x, y))) {
        aligned.depth(x, y) =
            std::exp(log_depth(x, y) + correction.offset(x, y));
        aligned.sigma(x, y) = static_cast<float>(
            calibration.stretch * SigmaOf({0.0,
                                           correction.sigma(x, y),
                                           std::max(steps(x, y) - kFlat, 0.f)},
                                          calibration.error_at_steps));
      }
    }
  }
  return aligned;
}

}  // namespace tsar
