// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Finds the weights of compose/depth_confidence.h by logistic regression, with
// equal weight for each scene: when a depth that was measured off the plane of
// its superpixel is nearer to the truth than the plane. For each scene it
// prints the effect of the weights fitted to the others: the shares of these
// pixels that are off by 5 %, right to 1 %, and of the measurements that were
// right to 1 % those that become wrong by over 2.5 %.
//
//   fit_measurements MODELED [MODELED ...]
//
// MODELED: see ModeledScene.

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/compose/depth_confidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/logistic_regression.h"
#include "benchmarks/modeled_scene.h"
#include <Eigen/Core>

namespace tsar {
namespace {

constexpr size_t kMaxSamples = 40000;  // Per scene.
// Errors beyond this count alike, as shares of the depth.
constexpr float kFullError = 0.025f;
constexpr float kMinGap = 0.3f;  // In relative depths of one pixel.

struct Sample {
  MeasurementSupport support;
  Rival rival;
  // Relative errors.
  float own_error;
  float rival_error;
};

Image<float> DepthsOfPlanes(const ModeledImage& view) {
  const std::vector<Plane> planes = PlanesOfSuperpixels(view.found);
  Image<float> depths(view.depth.Width(), view.depth.Height());
  for (int y = 0; y < depths.Height(); ++y) {
    for (int x = 0; x < depths.Width(); ++x) {
      const Plane& plane = planes[view.SuperpixelAt(x, y)];
      depths(x, y) =
          plane.Valid()
              ? std::max(0.f,
                         plane.Depth(view.intrinsics.Ray(
                             static_cast<float>(x), static_cast<float>(y))))
              : 0.f;
    }
  }
  return depths;
}

void CollectView(const ModeledImage& view,
                 Device& device,
                 std::vector<Sample>* samples) {
  const Image<float> rivals = DepthsOfPlanes(view);
  const Image<OcclusionVotes> votes = view.CountVotes(view.depth, device);
  const Image<OcclusionVotes> rival_votes = view.CountVotes(rivals, device);
  for (int y = 0; y < rivals.Height(); ++y) {
    for (int x = 0; x < rivals.Width(); ++x) {
      const float own = view.depth(x, y);
      const float rival = rivals(x, y);
      const uint8_t flags = view.flags(x, y);
      const float right = AtSamePlace(view.truth, x, y, rivals);
      if (!(own > 0.f) || !(right > 0.f) || !(rival > 0.f) ||
          GapInPixels(own, rival, view.resolution) < kMinGap ||
          (!MeasurementFlags::IsTrusted(flags) &&
           !MeasurementFlags::IsConfirmed(flags))) {
        continue;
      }
      samples->push_back({view.SupportAt(x, y, votes(x, y)),
                          {rival_votes(x, y),
                           GapInPixels(own, rival, view.resolution),
                           view.LabelAt(x, y).margin,
                           MisfitOf(rival_votes(x, y), votes(x, y))},
                          std::abs(own - right) / right,
                          std::abs(rival - right) / right});
    }
  }
}

std::vector<Sample> Collect(const std::string& root) {
  const ModeledScene scene(root);
  std::vector<Sample> samples;
  for (const auto& [image, labels] : scene.Model().views) {
    CollectView(scene.Load(image), scene.GetDevice(), &samples);
  }
  return TakeEvenly(samples, kMaxSamples);
}

using Scenes = std::vector<std::vector<Sample>>;

// A constant, the terms for the measurement, and those for its rival.
Eigen::VectorXd ContestRow(const Sample& sample) {
  const SupportTerms support(sample.support);
  const RivalTerms rival(sample.rival);
  Eigen::VectorXd row =
      Eigen::VectorXd::Ones(1 + SupportTerms::kCount + RivalTerms::kCount);
  for (int i = 0; i < SupportTerms::kCount; ++i) {
    row(1 + i) = support.values[i];
  }
  for (int i = 0; i < RivalTerms::kCount; ++i) {
    row(1 + SupportTerms::kCount + i) = rival.values[i];
  }
  return row;
}

// Which of two depths is nearer to the truth, weighted by the difference.
Eigen::VectorXd FitContest(const Scenes& scenes) {
  return SolveRegression(scenes, [](const Sample& sample) {
    const float own = std::min(sample.own_error / kFullError, 1.f);
    const float rival = std::min(sample.rival_error / kFullError, 1.f);
    return Case{ContestRow(sample), own < rival, std::abs(own - rival)};
  });
}

void PrintEffect(const char* name,
                 const std::vector<Sample>& scene,
                 const Eigen::VectorXd& weights) {
  double wrong = 0.0;
  double right = 0.0;
  double was_right = 0.0;
  double harmed = 0.0;
  for (const Sample& sample : scene) {
    const bool stands = ContestRow(sample).dot(weights) >
                        double{ComposeSceneOptions().min_log_odds};
    const float error = stands ? sample.own_error : sample.rival_error;
    wrong += error > 0.05f ? 1.0 : 0.0;
    right += error < 0.01f ? 1.0 : 0.0;
    was_right += sample.own_error < 0.01f ? 1.0 : 0.0;
    harmed += sample.own_error < 0.01f && error > 0.025f ? 1.0 : 0.0;
  }
  const double count = std::max(static_cast<double>(scene.size()), 1.0);
  std::printf(
      "%s: %zu pixels, off by 5 %% %.3f, right to 1 %% %.3f, harmed %.4f\n",
      name,
      scene.size(),
      wrong / count,
      right / count,
      harmed / std::max(was_right, 1.0));
}

int Fit(int argc, char** argv) {
  if (argc < 2) {
    throw Error(ErrorCode::kBadOption,
                "no workspace; name one or more that are modeled");
  }
  Scenes scenes;
  for (int i = 1; i < argc; ++i) {
    scenes.push_back(Collect(argv[i]));
  }
  CrossValidate(scenes, argv + 1, &FitContest, &PrintEffect, "LogOddsAgainst");
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::Fit, argc, argv);
}
