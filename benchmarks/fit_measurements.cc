// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Finds the weights of pipeline/measurement_support.h by logistic regression,
// with equal weight for each scene: when a depth that was measured off the
// plane of its superpixel is nearer to the truth than the plane, and when it is
// right to 1 %. Of each scene it prints what the weights that the others give
// would do there: the shares of these pixels that are off by 5 %, right to 1 %,
// and of the measurements that were right to 1 % those that become wrong by
// over 2.5 %.
//
//   fit_measurements MODELLED [MODELLED ...]
//
// MODELLED: a workspace with ground_truth/depth, of maps of at most 1280
// pixels, after tsar_refine's passes observe and model.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/controllers/load_view.h"
#include "colmap_tsar/pipeline/compose_scene.h"
#include "colmap_tsar/pipeline/find_scene.h"
#include "colmap_tsar/pipeline/gray.h"
#include "colmap_tsar/pipeline/measurement_support.h"
#include "colmap_tsar/pipeline/stage_options.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"
#include "colmap_tsar/scene_planes/refine_borders.h"
#include "colmap_tsar/scene_planes/texture_measures.h"
#include "colmap_tsar/store/evidence_file.h"
#include "colmap_tsar/store/scene_model_file.h"
#include "colmap_tsar/store/workspace.h"
#include "colmap_tsar/superpixels/cielab.h"
#include "colmap_tsar/workspace/map_io.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/logistic_regression.h"
#include <Eigen/Core>

namespace tsar {
namespace {

constexpr size_t kMaxSamples = 40000;  // Of a scene, evenly spaced.
// Errors beyond this count alike, as shares of the depth.
constexpr float kFullError = 0.025f;
constexpr float kMinGap = 0.3f;  // In relative depths of one pixel.

struct Sample {
  MeasurementSupport support;
  Rival rival;
  // Relative errors.
  float own_error;
  float rival_error;
  bool has_rival;  // Otherwise it stands.
};

class ModelledScene {
 public:
  explicit ModelledScene(const std::string& root)
      : workspace_(root, MapType::kGeometric),
        model_(ReadSceneModel(GetSceneModelPath(workspace_.Root()))),
        device_(Device::CreateCpu(2)) {
    for (const auto& [image, labels] : model_.views) {
      evidence_[image] = ReadEvidence(
          GetEvidencePath(workspace_.Root(), Name(image), workspace_.Type()));
    }
  }

  std::vector<Sample> Collect() {
    std::vector<Sample> samples;
    for (const auto& [image, labels] : model_.views) {
      CollectView(image, &samples);
    }
    std::vector<Sample> spread;
    const size_t count = std::min(samples.size(), kMaxSamples);
    for (size_t i = 0; i < count; ++i) {
      spread.push_back(samples[i * samples.size() / count]);
    }
    return spread;
  }

 private:
  const std::string& Name(int image) const {
    return workspace_.Model().images[static_cast<size_t>(image)].name;
  }

  ObservedView Observed(int image) const {
    return MakeObservedView(
        evidence_.at(image),
        workspace_.Model().images[static_cast<size_t>(image)].camera);
  }

  // As ComposeTask does it, with all other views as sources.
  void CollectView(int image, std::vector<Sample>* samples) {
    std::vector<ObservedView> views = {Observed(image)};
    std::vector<const ViewLabels*> labels = {&model_.views.at(image)};
    for (const auto& [other, of_other] : model_.views) {
      if (other != image) {
        views.push_back(Observed(other));
        labels.push_back(&of_other);
      }
    }
    RefineOptions options;
    options.curved_surfaces = false;
    const FoundScene found =
        FindScene(views, model_.planes, labels, options, *device_);
    const ViewData view = LoadView(workspace_, image);
    const ViewEvidence& evidence = evidence_.at(image);
    if (!view.depth.HasSizeOf(evidence.ratings)) {
      throw Error(ErrorCode::kMismatch,
                  workspace_.Root().string() +
                      ": maps of more than 1280 pixels; take smaller ones");
    }
    const Image<float> truth =
        ReadDepthMap(workspace_.SourceRoot() / "ground_truth" / "depth" /
                     (Name(image) + ".bin"));
    const DeviceImage<Rgb> color(*device_, evidence.color);
    const DeviceImage<float> device_depth(*device_, view.depth);
    DeviceImage<uint8_t> device_ratings(*device_, evidence.ratings);
    const DeviceImage<uint16_t> device_superpixels(*device_,
                                                   evidence.superpixels);
    const RefinedBorders refined =
        RefineBorders({device_superpixels.View(),
                       ConvertToLab(color.View(), *device_).View(),
                       device_depth.View(),
                       std::as_const(device_ratings).View(),
                       views[0].camera.GetIntrinsics(),
                       evidence.resolution},
                      found.labeled.labels,
                      found.labeled.planes,
                      MakeSceneOptions(options, views).borders,
                      *device_);
    DistrustFattened(refined.fattened.View(), device_ratings.View(), *device_);
    const Image<uint8_t> ratings = device_ratings.ToHost();
    const Image<uint16_t> superpixels = refined.superpixels.ToHost();
    const Image<float> texture =
        ComputeTexture(ComputeGray(color.View(), *device_).View(), *device_)
            .ToHost();
    const Intrinsics intrinsics = view.camera.GetIntrinsics();
    const std::vector<Plane> planes = PlanesOfSuperpixels(found.labeled);
    const auto superpixel = [&](int x, int y) {
      return static_cast<size_t>(superpixels(
          ReducedRaster::FromMap(x, view.depth.Width(), evidence.width),
          ReducedRaster::FromMap(y, view.depth.Height(), evidence.height)));
    };
    Image<float> rivals(view.depth.Width(), view.depth.Height());
    for (int y = 0; y < rivals.Height(); ++y) {
      for (int x = 0; x < rivals.Width(); ++x) {
        const Plane& plane = planes[superpixel(x, y)];
        rivals(x, y) =
            plane.Valid()
                ? std::max(0.f,
                           plane.Depth(intrinsics.Ray(static_cast<float>(x),
                                                      static_cast<float>(y))))
                : 0.f;
      }
    }
    const DeviceImage<float> device_rivals(*device_, rivals);
    const auto votes =
        CountViewVotes({views, found.planes_of_sources},
                       intrinsics,
                       {device_depth.View(), device_rivals.View()},
                       *device_);
    const Image<ViewVotes> own_votes = votes[0].ToHost();
    const Image<ViewVotes> rival_votes = votes[1].ToHost();
    for (int y = 0; y < rivals.Height(); ++y) {
      for (int x = 0; x < rivals.Width(); ++x) {
        const float own = view.depth(x, y);
        const float rival = rivals(x, y);
        const uint8_t rating = ratings(x, y);
        const float right = truth(x * truth.Width() / rivals.Width(),
                                  y * truth.Height() / rivals.Height());
        const bool has_rival = rival > 0.f;
        const float gap =
            has_rival ? GapInPixels(own, rival, evidence.resolution) : 0.f;
        if (!(own > 0.f) || !(right > 0.f) || (has_rival && gap < kMinGap) ||
            (!MeasurementRating::IsTrusted(rating) &&
             !MeasurementRating::IsConfirmed(rating))) {
          continue;
        }
        const float texture_here = texture(
            ReducedRaster::FromMap(x, rivals.Width(), evidence.width),
            ReducedRaster::FromMap(y, rivals.Height(), evidence.height));
        samples->push_back(
            {{own_votes(x, y),
              texture_here,
              MeasurementRating::IsTrusted(rating)},
             {rival_votes(x, y),
              gap,
              found.labeled.qualities[superpixel(x, y)].margin.Value()},
             std::abs(own - right) / right,
             std::abs(rival - right) / right,
             has_rival});
      }
    }
  }

  const Workspace workspace_;
  const SceneModel model_;
  const std::unique_ptr<Device> device_;
  std::map<int, ViewEvidence> evidence_;
};

using Scenes = std::vector<std::vector<Sample>>;

// A constant, and what speaks for the measurement.
Eigen::VectorXd SupportRow(const Sample& sample, Eigen::Index size) {
  const SupportTerms support(sample.support);
  Eigen::VectorXd row = Eigen::VectorXd::Ones(size);
  for (int i = 0; i < SupportTerms::kCount; ++i) {
    row(1 + i) = support.values[i];
  }
  return row;
}

Eigen::VectorXd ContestRow(const Sample& sample) {
  const RivalTerms rival(sample.rival);
  Eigen::VectorXd row =
      SupportRow(sample, 1 + SupportTerms::kCount + RivalTerms::kCount);
  for (int i = 0; i < RivalTerms::kCount; ++i) {
    row(1 + SupportTerms::kCount + i) = rival.values[i];
  }
  return row;
}

// The last value: whether it stands against a plane.
Eigen::VectorXd ProbabilityRow(const Sample& sample) {
  Eigen::VectorXd row = SupportRow(sample, 2 + SupportTerms::kCount);
  row(1 + SupportTerms::kCount) = sample.has_rival ? 1.0 : 0.0;
  return row;
}

// What a regression takes of a sample; none where the weight is 0.
struct Case {
  Eigen::VectorXd row;
  bool outcome = false;
  double weight = 0.0;
};

// With equal weight for each scene.
template <typename MakeCase>
Eigen::VectorXd Solve(const Scenes& scenes, const MakeCase& make_case) {
  std::vector<Case> cases;
  for (const std::vector<Sample>& scene : scenes) {
    for (const Sample& sample : scene) {
      Case made = make_case(sample);
      if (made.weight > 0.0) {
        made.weight /= static_cast<double>(scene.size());
        cases.push_back(std::move(made));
      }
    }
  }
  if (cases.empty()) {
    return {};
  }
  const auto num_rows = static_cast<Eigen::Index>(cases.size());
  LogisticRegression regression;
  regression.rows.resize(num_rows, cases[0].row.size());
  regression.outcomes.resize(num_rows);
  regression.weights.resize(num_rows);
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const Case& made = cases[static_cast<size_t>(i)];
    regression.rows.row(i) = made.row;
    regression.outcomes(i) = made.outcome ? 1.0 : 0.0;
    regression.weights(i) = made.weight;
  }
  regression.weights /= regression.weights.sum();
  return regression.Solve();
}

// Which of two depths is nearer to the truth, weighed by how much that matters.
Eigen::VectorXd FitContest(const Scenes& scenes) {
  return Solve(scenes, [](const Sample& sample) {
    if (!sample.has_rival) {
      return Case();
    }
    const float own = std::min(sample.own_error / kFullError, 1.f);
    const float rival = std::min(sample.rival_error / kFullError, 1.f);
    return Case{ContestRow(sample), own < rival, std::abs(own - rival)};
  });
}

// When a measurement that stands is right to 1 %.
Eigen::VectorXd FitProbability(const Scenes& scenes) {
  return Solve(scenes, [](const Sample& sample) {
    const bool stands =
        !sample.has_rival || LogOddsAgainst(sample.rival, sample.support) >
                                 ComposeSceneOptions().min_log_odds;
    return stands ? Case{ProbabilityRow(sample), sample.own_error < 0.01f, 1.0}
                  : Case();
  });
}

void PrintWeights(const char* name, const Eigen::VectorXd& weights) {
  std::printf("%s:", name);
  for (const double weight : weights) {
    std::printf(" %.2f", weight);
  }
  std::printf("\n");
}

void PrintEffect(const char* name,
                 const std::vector<Sample>& scene,
                 const Eigen::VectorXd& weights) {
  double wrong = 0.0;
  double right = 0.0;
  double was_right = 0.0;
  double harmed = 0.0;
  for (const Sample& sample : scene) {
    const bool stands =
        !sample.has_rival || ContestRow(sample).dot(weights) >
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

void Fit(int argc, char** argv) {
  if (argc < 2) {
    throw Error(ErrorCode::kBadOption,
                "no workspace; name one or more that are modelled");
  }
  Scenes scenes;
  for (int i = 1; i < argc; ++i) {
    scenes.push_back(ModelledScene(argv[i]).Collect());
  }
  for (size_t i = 0; scenes.size() > 1 && i < scenes.size(); ++i) {
    Scenes others = scenes;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    PrintEffect(argv[i + 1], scenes[i], FitContest(others));
  }
  PrintWeights("LogOddsAgainst", FitContest(scenes));
  PrintWeights("ProbabilityOf", FitProbability(scenes));
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
