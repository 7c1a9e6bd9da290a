// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Finds the weights of RateSurface() (scene_planes/surface_confidence.cc) by
// logistic regression of "the depth is right to 1 %" on what is known of the
// label of its superpixel, with equal weight for each scene.
//
//   fit_confidence MODELLED=REFINED [MODELLED=REFINED ...]
//
// MODELLED: a workspace with ground_truth/depth after tsar_refine's passes
// observe and model; REFINED: a copy of it after pass compose too; all passes
// with --TsarRefine.experiment cylinders=0, since depths on columns and pipes,
// which have a constant, would count as interpolated ones.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/pipeline/refined_maps.h"
#include "colmap_tsar/plane_export/plane_view.h"
#include "colmap_tsar/store/evidence_file.h"
#include "colmap_tsar/store/scene_model_file.h"
#include "colmap_tsar/store/workspace.h"
#include "colmap_tsar/workspace/map_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "benchmarks/logistic_regression.h"
#include "benchmarks/require_no_cylinders.h"
#include <Eigen/Core>

namespace tsar {
namespace {

constexpr float kRight = 0.01f;  // Of the depth.
// Evenly spaced samples of a scene for each kind of depth, at most; a scene
// with less than half as many counts less.
constexpr size_t kMaxSamples = 4000;

enum Kind {
  kMoved,
  kFilledByMeasured,
  kFilledByOthers,
  kGuessed,
  kStanding,
  kRegion,
  kInterpolated,
  kMovedToCurved,
  kFilledByCurved,
  kNumKinds
};
constexpr const char* kKindNames[kNumKinds] = {"moved",
                                               "filled, measured",
                                               "filled, by others",
                                               "guessed",
                                               "standing",
                                               "region",
                                               "interpolated",
                                               "moved to curved",
                                               "filled by curved"};

enum Measure { kStrength, kConfirmed, kUncertainty, kMargin, kNumMeasures };
constexpr const char* kMeasureNames[kNumMeasures] = {
    "strength", "confirmed", "uncertainty", "margin"};

const std::array<std::vector<int>, kNumKinds> kMeasuresOfKinds = {
    std::vector<int>{kConfirmed, kMargin},
    {kConfirmed, kUncertainty, kMargin},
    {kStrength},
    {kStrength, kUncertainty, kMargin},
    {},
    {},
    {},
    {},
    {}};

struct Sample {
  std::array<float, kNumMeasures> measures;
  bool is_right;
};
using SamplesOfScene = std::array<std::vector<Sample>, kNumKinds>;

// What is known of a pixel with a depth.
struct Pixel {
  Provenance source;
  bool is_on_plane;  // Of the scene.
  bool keeps_depth;  // That was measured.
  bool is_labelled;  // Its superpixel has a plane.
  LabelEvidence evidence;
};

// As RateSceneConfidence() tells them apart, but that depths on curved surfaces
// are known here by what they are not.
Kind KindOf(const Pixel& pixel) {
  if (pixel.source == Provenance::kInterpolated) {
    return kInterpolated;
  }
  if (pixel.source == Provenance::kMeasured) {
    return pixel.is_on_plane    ? kMoved
           : !pixel.keeps_depth ? kMovedToCurved
                                : kStanding;
  }
  return !pixel.is_on_plane ? (pixel.is_labelled ? kFilledByCurved : kRegion)
         : pixel.evidence == LabelEvidence::kMeasured ? kFilledByMeasured
         : pixel.evidence == LabelEvidence::kGuessed  ? kGuessed
                                                      : kFilledByOthers;
}

// The pixel of an image of another size at the same place.
template <typename T>
const T& AtSamePlace(const Image<T>& image,
                     int x,
                     int y,
                     const Image<float>& of) {
  return image(x * image.Width() / of.Width(),
               y * image.Height() / of.Height());
}

void CollectView(const PlaneView& view,
                 const ViewEvidence& evidence,
                 const ViewLabels& labels,
                 const Image<float>& original,
                 const Image<float>& truth,
                 SamplesOfScene* samples) {
  for (int y = 0; y < view.depth.Height(); ++y) {
    for (int x = 0; x < view.depth.Width(); ++x) {
      const float depth = view.depth(x, y);
      const float right = AtSamePlace(truth, x, y, view.depth);
      if (!(depth > 0.f) || !(right > 0.f)) {
        continue;
      }
      const size_t superpixel =
          AtSamePlace(evidence.superpixels, x, y, view.depth);
      const LabelQuality& quality = labels.qualities[superpixel];
      const Kind kind = KindOf({static_cast<Provenance>(view.provenance(x, y)),
                                view.planes(x, y) > 0,
                                depth == original(x, y),
                                labels.planes[superpixel] >= 0,
                                labels.evidence[superpixel]});
      (*samples)[kind].push_back({{quality.strength.Value(),
                                   quality.confirmed.Value(),
                                   quality.uncertainty.Value(),
                                   quality.margin.Value()},
                                  std::abs(depth - right) < kRight * right});
    }
  }
}

SamplesOfScene CollectScene(const std::string& modelled_root,
                            const std::string& refined_root) {
  const Workspace modelled(modelled_root, MapType::kGeometric);
  const Workspace refined(refined_root, MapType::kGeometric);
  const SceneModel model = ReadSceneModel(GetSceneModelPath(modelled.Root()));
  RequireNoCylinders(model, modelled.Root());
  SamplesOfScene samples;
  for (const auto& [image, labels] : model.views) {
    const std::string& name =
        modelled.Model().images[static_cast<size_t>(image)].name;
    CollectView(
        ReadPlaneView(refined, image, static_cast<int>(model.planes.size())),
        ReadEvidence(GetEvidencePath(modelled.Root(), name, modelled.Type())),
        labels,
        ReadDepthMap(modelled.DepthPath(image, MapType::kGeometric)),
        ReadDepthMap(modelled.SourceRoot() / "ground_truth" / "depth" /
                     (name + ".bin")),
        &samples);
  }
  return samples;
}

LogisticRegression MakeRegression(const std::vector<SamplesOfScene>& scenes,
                                  Kind kind) {
  const std::vector<int>& measures = kMeasuresOfKinds[kind];
  std::vector<std::pair<Sample, double>> used;
  for (const SamplesOfScene& scene : scenes) {
    const std::vector<Sample>& samples = scene[kind];
    const size_t count = std::min(samples.size(), kMaxSamples);
    const double weight_of_scene =
        std::min(1.0, 2.0 * static_cast<double>(count) / kMaxSamples);
    for (size_t i = 0; i < count; ++i) {
      used.emplace_back(samples[i * samples.size() / count],
                        weight_of_scene / static_cast<double>(count));
    }
  }
  const auto num_rows = static_cast<Eigen::Index>(used.size());
  LogisticRegression regression;
  regression.rows.setOnes(num_rows,
                          1 + static_cast<Eigen::Index>(measures.size()));
  regression.outcomes.resize(num_rows);
  regression.weights.resize(num_rows);
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const auto& [sample, weight] = used[static_cast<size_t>(i)];
    for (size_t j = 0; j < measures.size(); ++j) {
      regression.rows(i, 1 + static_cast<Eigen::Index>(j)) =
          sample.measures[static_cast<size_t>(measures[j])];
    }
    regression.outcomes(i) = sample.is_right ? 1.0 : 0.0;
    regression.weights(i) = weight;
  }
  regression.weights /= std::max(regression.weights.sum(), 1e-12);
  return regression;
}

void Print(const std::vector<SamplesOfScene>& scenes, Kind kind) {
  const LogisticRegression regression = MakeRegression(scenes, kind);
  if (regression.rows.rows() == 0) {
    return;
  }
  const Eigen::VectorXd solution = regression.Solve();
  std::printf("%-18s %7lld samples, %.2f right: constant %.2f",
              kKindNames[kind],
              static_cast<long long>(regression.rows.rows()),
              regression.weights.dot(regression.outcomes),
              solution(0));
  for (size_t j = 0; j < kMeasuresOfKinds[kind].size(); ++j) {
    std::printf(", %s %.2f",
                kMeasureNames[kMeasuresOfKinds[kind][j]],
                solution(1 + static_cast<Eigen::Index>(j)));
  }
  std::printf("\n");
}

void Fit(int argc, char** argv) {
  std::vector<SamplesOfScene> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string roots = argv[i];
    const size_t equals = roots.find('=');
    if (equals == std::string::npos) {
      throw Error(ErrorCode::kBadOption,
                  roots + ": is no MODELLED=REFINED; name two workspaces");
    }
    scenes.push_back(
        CollectScene(roots.substr(0, equals), roots.substr(equals + 1)));
  }
  for (int kind = 0; kind < kNumKinds; ++kind) {
    Print(scenes, static_cast<Kind>(kind));
  }
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  try {
    tsar::Fit(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ERROR: %s\n", error.what());
    return 1;
  }
  return 0;
}
