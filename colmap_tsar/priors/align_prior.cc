// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/align_prior.h"

#include "colmap_tsar/priors/axis_sample.h"
#include "colmap_tsar/priors/correct_prior.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/priors/fit_prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
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
// Steps of the prior make depths within this share of the image's long side
// uncertain, unless they are below kFlat. The larger share is for priors that
// are not aligned with their images: it is used if pixels without steps within
// the smaller share have more outliers, by this factor and share, than those
// without steps within the larger one.
constexpr double kEdgeWidth = 0.004;
constexpr double kLargeEdgeWidth = 0.02;
constexpr float kMoreOutliers = 2.f;
constexpr float kManyOutliers = 0.01f;
constexpr float kFlat = 0.03f;
constexpr float kEdge = 0.1f;
constexpr size_t kMinEdgeSamples = 50;

Eigen::Map<Eigen::ArrayXf> AsArray(Image<float>* image) {
  return {image->Data(), static_cast<Eigen::Index>(image->NumPixels())};
}

bool IsMeasured(const RayDepth& sample) { return sample.z > 0.f; }

bool IsValue(float value) { return value > 0.f && std::isfinite(value); }

// The prior's values in the pixels of a raster: interpolated where all four
// neighbors have one, so that slanted surfaces do not become stairs.
Image<float> Resample(const Image<float>& values, int width, int height) {
  Image<float> result(width, height);
  const std::vector<AxisSample> columns = AxisSamples(values.Width(), width);
  for (int y = 0; y < height; ++y) {
    const AxisSample row = AxisSample::At(y, values.Height(), height);
    const float* const top = &values(0, row.first);
    const float* const bottom = &values(0, row.second);
    for (int x = 0; x < width; ++x) {
      const AxisSample& column = columns[x];
      const auto [x0, x1, share] = column;
      if (IsValue(top[x0]) && IsValue(top[x1]) && IsValue(bottom[x0]) &&
          IsValue(bottom[x1])) {
        result(x, y) =
            (1.f - row.share) * ((1.f - share) * top[x0] + share * top[x1]) +
            row.share * ((1.f - share) * bottom[x0] + share * bottom[x1]);
      } else {
        const float nearest = values(column.Nearest(), row.Nearest());
        result(x, y) = IsValue(nearest) ? nearest : 0.f;
      }
    }
  }
  return result;
}

// NaN where the function has no depth.
Image<float> LogDepth(const PriorFunction& function, Image<float> values) {
  auto value = AsArray(&values);
  const Eigen::ArrayXf result = value * static_cast<float>(function.scale) +
                                static_cast<float>(function.shift);
  const Eigen::ArrayXf logarithm =
      (function.type == PriorType::kInverse ? -1.f : 1.f) * result.log();
  value = (value > 0.f && result > 0.f && result.isFinite())
              .select(logarithm, kNone);
  return values;
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

// The error of the corrected prior at a measurement that was held out.
struct Prediction {
  float error = 0.f;
  float sigma = 0.f;
  size_t pixel = 0;
};

std::vector<Prediction> Predict(const Image<float>& residual,
                                const PriorCorrection& correction) {
  std::vector<Prediction> predictions;
  for (int y = 0; y < residual.Height(); ++y) {
    for (int x = 0; x < residual.Width(); ++x) {
      if (!std::isnan(residual(x, y)) && IsLeftOut(x, y, residual)) {
        predictions.push_back({residual(x, y) - correction.offset(x, y),
                               correction.sigma(x, y),
                               residual.View().Index(x, y)});
      }
    }
  }
  return predictions;
}

// The size of errors at steps of the prior, as a share of the step.
float ErrorAtSteps(const std::vector<Prediction>& predictions,
                   const Image<float>& steps) {
  std::vector<float> shares;
  for (const Prediction& prediction : predictions) {
    if (const float step = steps.Data()[prediction.pixel];
        step > kEdge - kFlat) {
      shares.push_back(prediction.error / step);
    }
  }
  return shares.size() >= kMinEdgeSamples
             ? std::min(static_cast<float>(RobustSpread(std::move(shares))),
                        1.f)
             : 0.5f;
}

// The error model of a prior, estimated from prediction errors.
struct Calibration {
  float error_at_steps = 0.5f;
  // The factor of sigma.
  float stretch = 1.f;
  float outlier_share = kMaxOutlierShare;
  float outlier_share_if_flat = 0.f;  // Where there is no step.
};

Calibration Calibrate(const std::vector<Prediction>& predictions,
                      const Image<float>& steps) {
  Calibration calibration;
  if (predictions.empty()) {
    return calibration;
  }
  calibration.error_at_steps = ErrorAtSteps(predictions, steps);
  std::vector<float> ratios;
  std::vector<float> ratios_if_flat;
  for (const auto& [error, sigma, pixel] : predictions) {
    const float step = steps.Data()[pixel];
    const float at_step = calibration.error_at_steps * step;
    ratios.push_back(error / std::sqrt(sigma * sigma + at_step * at_step));
    if (!(step > 0.f)) {
      ratios_if_flat.push_back(ratios.back());
    }
  }
  calibration.stretch = std::max(1.f, static_cast<float>(RobustSpread(ratios)));
  calibration.outlier_share = ShareOfOutliers(ratios, calibration.stretch);
  calibration.outlier_share_if_flat =
      ShareOfOutliers(ratios_if_flat, calibration.stretch);
  return calibration;
}

// The excess over kFlat of the prior's steps within a share of the long side.
Image<float> StepsWithin(double width, const Image<float>& log_depth) {
  const int side = std::max(log_depth.Width(), log_depth.Height());
  Image<float> steps = LocalRange(
      log_depth, std::max(1, static_cast<int>(std::lround(width * side))));
  for (float& step : steps) {
    step = std::max(step - kFlat, 0.f);
  }
  return steps;
}

std::string DescribeDepths(const PriorAssessment& assessment) {
  const std::string as_type =
      "as " + ToString(assessment.type) + " depth it explains ";
  const std::string share =
      std::to_string(std::lround(100.f * assessment.skill)) +
      " % of the spread of the measured depths";
  switch (assessment.verdict) {
    case PriorVerdict::kNone:
      return "";
    case PriorVerdict::kUsed:
      return "depth prior used: " + as_type + share;
    case PriorVerdict::kNoDepth:
      return "depth prior not used: it has no depths";
    case PriorVerdict::kFewMeasured:
      return "depth prior not used: too few of its pixels were measured";
    case PriorVerdict::kUnlike:
      return "depth prior not used: " + as_type + "only " + share;
    case PriorVerdict::kOthersUnlike:
      break;
  }
  return "depth prior not used: those of most images explain too little of "
         "the measured depths, though " +
         as_type + share;
}

std::string DescribeNormals(const PriorAssessment& assessment) {
  constexpr float kDegrees = 57.29578f;
  const std::string deviation =
      "they deviate by " +
      std::to_string(std::lround(kDegrees * assessment.normal_sigma)) +
      " degrees from those of measured planes";
  switch (assessment.of_normals) {
    case PriorVerdict::kNone:
    case PriorVerdict::kNoDepth:
      return "";
    case PriorVerdict::kUsed:
      return "normals used: " + deviation;
    case PriorVerdict::kFewMeasured:
      return "normals not used: too few planes were measured";
    case PriorVerdict::kUnlike:
      return "normals not used: " + deviation;
    case PriorVerdict::kOthersUnlike:
      break;
  }
  return "normals not used: the priors of most images do not fit";
}

}  // namespace

std::string Describe(const PriorAssessment& assessment) {
  const std::string of_normals = DescribeNormals(assessment);
  if (of_normals.empty()) {
    return DescribeDepths(assessment);
  }
  const bool has_depths = assessment.verdict != PriorVerdict::kNone &&
                          assessment.verdict != PriorVerdict::kNoDepth;
  return (has_depths ? DescribeDepths(assessment) + "; " : "") + of_normals;
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
  Image<float> values = Resample(prior.values, width, height);
  std::vector<PriorSample> measured;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
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
  Image<float> log_depth = LogDepth(fit.function, std::move(values));
  Image<float> residual(width, height, kNone);
  Image<float> kept(width, height, kNone);  // Without the held out.
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (IsMeasured(samples(x, y))) {
        residual(x, y) = std::log(samples(x, y).z) - log_depth(x, y);
        kept(x, y) = IsLeftOut(x, y, residual) ? kNone : residual(x, y);
      }
    }
  }
  const std::vector<Prediction> predictions =
      Predict(residual, CorrectPrior(log_depth, kept));
  Image<float> steps = StepsWithin(kEdgeWidth, log_depth);
  Calibration calibration = Calibrate(predictions, steps);
  Image<float> more_steps = StepsWithin(kLargeEdgeWidth, log_depth);
  const Calibration with_more = Calibrate(predictions, more_steps);
  if (calibration.outlier_share_if_flat >
      kMoreOutliers * with_more.outlier_share_if_flat + kManyOutliers) {
    steps = std::move(more_steps);
    calibration = with_more;
  }
  aligned.outlier_share = BoundedOutlierShare(calibration.outlier_share);
  PriorCorrection correction = CorrectPrior(log_depth, residual);
  auto depth = AsArray(&correction.offset);
  auto sigma = AsArray(&correction.sigma);
  depth = (AsArray(&log_depth) + depth).exp();
  sigma =
      calibration.stretch *
      (sigma.square() + (calibration.error_at_steps * AsArray(&steps)).square())
          .sqrt();
  depth = sigma.isNaN().select(0.f, depth);
  sigma = sigma.isNaN().select(0.f, sigma);
  aligned.depth = std::move(correction.offset);
  aligned.sigma = std::move(correction.sigma);
  return aligned;
}

}  // namespace tsar
