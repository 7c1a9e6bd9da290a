// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Finds the weights of ConfidenceOf() (compose/depth_confidence.h) by logistic
// regression of "the depth is right to 1 %" on all known terms, with equal
// weight for each scene. For each scene it prints the calibration error of the
// weights fitted to the others: the mean difference, over ten classes of the
// confidence, between it and the share of depths that are right.
//
//   fit_confidence MODELED=REFINED [MODELED=REFINED ...]
//
// MODELED: see ModeledScene; REFINED: a copy of it after pass compose too;
// all passes with --TsarRefine.cylinders 0, since depths on columns
// and pipes, which have a constant, would count as interpolated ones.

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/compose/depth_confidence.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/logistic_regression.h"
#include "benchmarks/modeled_scene.h"
#include <Eigen/Core>

namespace tsar {
namespace {

constexpr float kRight = 0.01f;        // A fraction of the depth.
constexpr size_t kMaxSamples = 40000;  // Per scene.

struct Sample {
  DepthEvidence depth;
  bool is_right;
};
using Scenes = std::vector<std::vector<Sample>>;

// As ComputeSceneConfidence() tells them apart.
DepthKind KindAt(const PlaneView& refined,
                 const ModeledImage& view,
                 int x,
                 int y) {
  const auto source = static_cast<Provenance>(refined.provenance(x, y));
  if (source == Provenance::kInterpolated) {
    return DepthKind::kInterpolated;
  }
  if (source == Provenance::kMeasured) {
    return refined.planes(x, y) > 0 ? DepthKind::kMoved : DepthKind::kStanding;
  }
  switch (view.found.labels.origins[view.SuperpixelAt(x, y)]) {
    case LabelOrigin::kMeasured:
      return DepthKind::kFilled;
    case LabelOrigin::kCarried:
      return DepthKind::kCarried;
    default:
      return DepthKind::kGuessed;
  }
}

void CollectView(const ModeledImage& view,
                 const PlaneView& refined,
                 Device& device,
                 std::vector<Sample>* samples) {
  const Image<OcclusionVotes> votes = view.CountVotes(refined.depth, device);
  for (int y = 0; y < refined.depth.Height(); ++y) {
    for (int x = 0; x < refined.depth.Width(); ++x) {
      const float depth = refined.depth(x, y);
      const float right = AtSamePlace(view.truth, x, y, refined.depth);
      // The confidence of a depth from a prior is the prior's own.
      const bool is_of_prior = static_cast<Provenance>(refined.provenance(
                                   x, y)) == Provenance::kPrior;
      if (depth > 0.f && right > 0.f && !is_of_prior) {
        samples->push_back({{KindAt(refined, view, x, y),
                             view.SupportAt(x, y, votes(x, y)),
                             view.LabelAt(x, y),
                             view.resolution.RelativeDepthError(depth),
                             view.noise},
                            std::abs(depth - right) < kRight * right});
      }
    }
  }
}

std::vector<Sample> Collect(const std::string& modeled_root,
                            const std::string& refined_root) {
  const ModeledScene scene(modeled_root);
  RequireNoCylinders(scene.Model(), scene.Root());
  const Workspace refined(refined_root, MapType::kGeometric);
  const int num_planes = static_cast<int>(scene.Model().planes.size());
  std::vector<Sample> samples;
  for (const auto& [image, labels] : scene.Model().views) {
    CollectView(scene.Load(image),
                ReadPlaneView(refined, image, num_planes),
                scene.GetDevice(),
                &samples);
  }
  return TakeEvenly(samples, kMaxSamples);
}

Eigen::VectorXd RowOf(const Sample& sample) {
  const ConfidenceTerms terms(sample.depth);
  Eigen::VectorXd row(ConfidenceTerms::kCount);
  std::copy(std::begin(terms.values), std::end(terms.values), row.begin());
  return row;
}

Eigen::VectorXd FitConfidence(const Scenes& scenes) {
  return SolveRegression(scenes, [](const Sample& sample) {
    return Case{RowOf(sample), sample.is_right, 1.0};
  });
}

void PrintCalibration(const char* name,
                      const std::vector<Sample>& scene,
                      const Eigen::VectorXd& weights) {
  struct Class {
    double count = 0.0;
    double confidence = 0.0;
    double right = 0.0;
  };
  std::array<Class, 10> classes;
  for (const Sample& sample : scene) {
    const double confidence =
        1.0 / (1.0 + std::exp(-RowOf(sample).dot(weights)));
    Class& of_sample =
        classes[std::clamp(static_cast<int>(10.0 * confidence), 0, 9)];
    of_sample.count += 1.0;
    of_sample.confidence += confidence;
    of_sample.right += sample.is_right ? 1.0 : 0.0;
  }
  double error = 0.0;
  for (const Class& one : classes) {
    error += std::abs(one.confidence - one.right);
  }
  std::printf("%s: %zu depths, calibration error %.3f\n",
              name,
              scene.size(),
              error / std::max(static_cast<double>(scene.size()), 1.0));
}

int Fit(int argc, char** argv) {
  Scenes scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string roots = argv[i];
    const size_t equals = roots.find('=');
    if (equals == std::string::npos) {
      throw Error(ErrorCode::kBadOption,
                  roots + ": is no MODELED=REFINED; name two workspaces");
    }
    scenes.push_back(
        Collect(roots.substr(0, equals), roots.substr(equals + 1)));
  }
  CrossValidate(
      scenes, argv + 1, &FitConfidence, &PrintCalibration, "ConfidenceOf");
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::Fit, argc, argv);
}
