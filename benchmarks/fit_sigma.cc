// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// How well sigma maps are calibrated, and the constants of SceneSigmaOptions
// (compose/depth_sigma.h) that would calibrate them: of the depths that are
// right to 1 %, the share whose error is less than one and than two standard
// deviations, for each origin of depths. These should be 0.68 and 0.95.
//
//   fit_sigma REFINED [REFINED ...]
//
// REFINED: a workspace with ground_truth/depth that tsar_refine has refined, or
// an output workspace of one, all with scene_planes or all without, with
// --TsarRefine.cylinders 0: depths on columns and pipes would count
// as interpolated ones. Prints a table for a standard deviation of one pixel of
// disparity, one for the sigma maps, and for each kind of depth the constant
// for which the median of the scenes' first shares is 0.68.

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/reduce_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/modeled_scene.h"

namespace tsar {
namespace {

constexpr float kRight = 0.01f;  // A fraction of the depth.
constexpr double kNormalShare = 0.6827;
// Scenes with fewer depths of a kind do not count for it.
constexpr size_t kMinSamples = 500;

enum Kind {
  kMoved,
  kFilledMeasured,
  kFilledCarried,
  kGuessed,
  kStanding,
  kInterpolated,
  // Depths of images that were refined on their own.
  kViewMeasured,
  kViewSuperpixel,
  kViewRegion,
  kViewInterpolated,
  kNumKinds
};
struct KindFacts {
  const char* name;
  float constant;  // In SceneSigmaOptions or ViewSigmaOptions.
};

const KindFacts& FactsOf(Kind kind) {
  static const SceneSigmaOptions scene;
  static const ViewSigmaOptions view;
  static const std::array<KindFacts, kNumKinds> facts = {{
      {"measured, moved onto its plane", scene.moved},
      {"filled, measured", scene.filled_measured},
      {"filled, other views", scene.filled_carried},
      {"filled, guessed", scene.filled_guessed},
      {"measured, as it was", scene.standing},
      {"interpolated", scene.interpolated},
      {"measured", view.measured},
      {"plane of a superpixel", view.superpixel_plane},
      {"plane of a region", view.region_plane},
      {"interpolated", view.interpolated},
  }};
  return facts[kind];
}

// All in fractions of the depth.
struct Sample {
  float error;
  float sigma;
  float unit;  // One pixel of disparity.

  // The standard deviation with another constant; a plane's own error stays.
  double SigmaWith(Kind kind, double constant) const {
    const double old_constant = FactsOf(kind).constant;
    if (kind == kStanding) {
      return sigma * constant / old_constant;
    }
    const double old_part = old_constant * unit;
    const double plane = std::max(0.0, sigma * sigma - old_part * old_part);
    return std::sqrt(plane + constant * constant * unit * unit);
  }
};
struct Scene {
  std::string name;
  std::array<std::vector<Sample>, kNumKinds> samples;
};

Kind KindOf(Provenance source, bool is_on_plane) {
  switch (source) {
    case Provenance::kInterpolated:
      return kInterpolated;
    case Provenance::kMeasured:
      return is_on_plane ? kMoved : kStanding;
    case Provenance::kOtherViews:
      return kFilledCarried;
    case Provenance::kGuessed:
      return kGuessed;
    default:
      return kFilledMeasured;
  }
}

Kind KindInView(Provenance source) {
  switch (source) {
    case Provenance::kMeasured:
      return kViewMeasured;
    case Provenance::kSuperpixelPlane:
      return kViewSuperpixel;
    case Provenance::kInterpolated:
      return kViewInterpolated;
    default:
      return kViewRegion;
  }
}

DepthResolution ResolutionOf(const Workspace& workspace,
                             int image,
                             const Camera& camera) {
  std::vector<Camera> sources;
  for (const StereoProblem& problem : workspace.Problems()) {
    if (problem.reference == image) {
      for (const int source : problem.sources) {
        sources.push_back(workspace.Model().images[source].camera);
      }
    }
  }
  return ComputeDisparityScale(camera, sources);
}

void CollectView(const Workspace& workspace, int image, Scene* scene) {
  const SparseModel::ModelImage& model_image = workspace.Model().images[image];
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const Image<float> depths = ReadDepthMap(paths.depth);
  const auto require_size = [&](const ContainedPath& path, auto map) {
    return RequireSizeOf(depths, path, std::move(map));
  };
  const Image<float> sigma =
      require_size(paths.sigma, ReadSigmaMap(paths.sigma));
  const Image<uint8_t> provenance =
      require_size(paths.provenance, ReadGrayPng(paths.provenance));
  const bool is_of_scene = Exists(paths.planes);
  const Image<uint16_t> planes =
      is_of_scene ? require_size(paths.planes, ReadGray16Png(paths.planes))
                  : Image<uint16_t>();
  const Image<float> truth = ReadTruth(workspace, model_image.name);
  const int width = depths.Width();
  const int height = depths.Height();
  DepthResolution resolution =
      ResolutionOf(workspace, image, model_image.camera.Resized(width, height));
  if (is_of_scene) {
    // Sigma maps count pixels of the view as it was judged.
    resolution.error_per_depth *=
        static_cast<float>(ReductionFactor(width, height));
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float depth = depths(x, y);
      const float right = AtSamePlace(truth, x, y, depths);
      const float error = std::abs(depth - right);
      if (depth > 0.f && right > 0.f && error < kRight * right) {
        const auto source = static_cast<Provenance>(provenance(x, y));
        if (source == Provenance::kPrior) {
          continue;  // Its sigma is its own, without a constant.
        }
        const Kind kind =
            is_of_scene ? KindOf(source, planes(x, y) > 0) : KindInView(source);
        scene->samples[kind].push_back({error / depth,
                                        sigma(x, y) / depth,
                                        resolution.RelativeDepthError(depth)});
      }
    }
  }
}

Scene CollectScene(const std::string& root) {
  const Workspace workspace(root, MapType::kGeometric);
  if (std::filesystem::exists(GetSceneModelPath(workspace.Root()))) {
    RequireNoCylinders(ReadSceneModel(GetSceneModelPath(workspace.Root()),
                                      SceneModelParts::kWithoutLabels),
                       workspace.Root());
  }
  Scene scene;
  scene.name = std::filesystem::path(root).lexically_normal().filename();
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    if (Exists(workspace.Paths(image, workspace.Type()).sigma)) {
      CollectView(workspace, image, &scene);
    }
  }
  return scene;
}

// The share of errors below this many standard deviations.
template <typename Sigma>
double ShareBelow(const std::vector<Sample>& samples,
                  double num_sigmas,
                  Sigma sigma_of) {
  const auto num_below =
      std::count_if(samples.begin(), samples.end(), [&](const Sample& sample) {
        return sample.error < num_sigmas * sigma_of(sample);
      });
  return static_cast<double>(num_below) / static_cast<double>(samples.size());
}

// The median over the scenes that have enough such depths, at least one.
template <typename Sigma>
double MedianShare(const std::vector<Scene>& scenes,
                   Kind kind,
                   double num_sigmas,
                   Sigma sigma_of) {
  std::vector<double> shares;
  for (const Scene& scene : scenes) {
    if (scene.samples[kind].size() >= kMinSamples) {
      shares.push_back(ShareBelow(scene.samples[kind], num_sigmas, sigma_of));
    }
  }
  std::sort(shares.begin(), shares.end());
  const size_t middle = shares.size() / 2;
  return shares.size() % 2 == 1 ? shares[middle]
                                : 0.5 * (shares[middle - 1] + shares[middle]);
}

// Those of which some scene has enough.
std::vector<Kind> KindsOf(const std::vector<Scene>& scenes) {
  std::vector<Kind> kinds;
  for (int kind = 0; kind < kNumKinds; ++kind) {
    if (std::any_of(scenes.begin(), scenes.end(), [&](const Scene& scene) {
          return scene.samples[kind].size() >= kMinSamples;
        })) {
      kinds.push_back(static_cast<Kind>(kind));
    }
  }
  return kinds;
}

template <typename Sigma>
void PrintTable(const std::vector<Scene>& scenes,
                const std::vector<Kind>& kinds,
                const char* title,
                Sigma sigma_of) {
  std::printf("%s\n\n| scene |", title);
  for (const Kind kind : kinds) {
    std::printf(" %s |", FactsOf(kind).name);
  }
  std::printf("\n|---|");
  for (size_t i = 0; i < kinds.size(); ++i) {
    std::printf("---|");
  }
  for (const Scene& scene : scenes) {
    std::printf("\n| %s |", scene.name.c_str());
    for (const Kind kind : kinds) {
      const std::vector<Sample>& samples = scene.samples[kind];
      if (samples.size() < kMinSamples) {
        std::printf(" |");
      } else {
        std::printf(" %.2f %.2f |",
                    ShareBelow(samples, 1.0, sigma_of),
                    ShareBelow(samples, 2.0, sigma_of));
      }
    }
  }
  std::printf("\n| median |");
  for (const Kind kind : kinds) {
    std::printf(" %.2f %.2f |",
                MedianShare(scenes, kind, 1.0, sigma_of),
                MedianShare(scenes, kind, 2.0, sigma_of));
  }
  std::printf("\n\n");
}

// By bisection: the larger the constant, the larger the share.
double FitConstant(const std::vector<Scene>& scenes, Kind kind) {
  double low = 0.0;
  double high = 100.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    const double share =
        MedianShare(scenes, kind, 1.0, [&](const Sample& sample) {
          return sample.SigmaWith(kind, middle);
        });
    (share < kNormalShare ? low : high) = middle;
  }
  return high;
}

int Fit(int argc, char** argv) {
  std::vector<Scene> scenes;
  for (int i = 1; i < argc; ++i) {
    scenes.push_back(CollectScene(argv[i]));
  }
  const std::vector<Kind> kinds = KindsOf(scenes);
  PrintTable(scenes, kinds, "One pixel of disparity", [](const Sample& sample) {
    return sample.unit;
  });
  PrintTable(scenes, kinds, "Sigma maps", [](const Sample& sample) {
    return sample.sigma;
  });
  for (const Kind kind : kinds) {
    std::printf("%-32s constant %.3f, for 0.68 %.3f\n",
                FactsOf(kind).name,
                static_cast<double>(FactsOf(kind).constant),
                FitConstant(scenes, kind));
  }
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::Fit, argc, argv);
}
