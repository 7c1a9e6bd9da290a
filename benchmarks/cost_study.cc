// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Do the costs that patch_match_stereo exports (--PatchMatchStereo.
// write_cost_maps) equal those that tsar_refine computes? For each workspace
// with exported costs, prints how c_min of the same hypotheses differs: with
// the window as tsar_refine samples it (every second row and column), with all
// 121 pixels of it, and with all pixels of images like those that COLMAP reads
// (gray by Rec. 709, in whole numbers, black around the image).
//
// Types of maps without exported costs are skipped.
//
//   cost_study WORKSPACE [WORKSPACE ...]

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/matching/sample_gray.cuh"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace tsar {
namespace {

// The stride of the pixels compared; all of them would take minutes.
constexpr int kStride = 3;

// The image as COLMAP reads it, in gray.
Image<float> ColmapGray(const Image<Rgb>& color) {
  Image<float> gray(color.Width(), color.Height());
  std::transform(color.begin(), color.end(), gray.begin(), [](const Rgb& c) {
    return std::floor(0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b + 0.5f);
  });
  return gray;
}

// Between pixels, with black around the image, as COLMAP's textures have it.
float SampleInBlack(const ImageView<const float>& image, float x, float y) {
  const auto at = [&](int u, int v) {
    return u < 0 || v < 0 || u >= image.width || v >= image.height
               ? 0.f
               : image(u, v);
  };
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  return (1.f - fy) * ((1.f - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1.f - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

// 1 - NCC with every pixel of the window, in double precision; undefined where
// a window has no texture by COLMAP's bound (1e-5 of the squared range). The
// samplers give the gray of the image and of the other at a position.
template <typename Sampler, typename OtherSampler>
double FullWindowCost(const Sampler& sample,
                      const OtherSampler& sample_other,
                      const PlaneHomography& homography,
                      int x,
                      int y) {
  constexpr double kMinVariance = 1e-5 * 255 * 255;
  const double center = sample(x, y);
  double sum_weight = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0,
         sum_ab = 0;
  for (int dy = -kPatchRadius; dy <= kPatchRadius; ++dy) {
    for (int dx = -kPatchRadius; dx <= kPatchRadius; ++dx) {
      const auto mapped = [&](int row) {
        const float* h = homography.h + 3 * row;
        return h[0] * (x + dx) + h[1] * (y + dy) + h[2];
      };
      const float z = mapped(2);
      if (!(z > 0)) {
        return kUndefinedCost;
      }
      const double a = sample(x + dx, y + dy);
      const double b = sample_other(mapped(0) / z, mapped(1) / z);
      const double w =
          std::exp(-(dx * dx + dy * dy) /
                       (2. * kPatchSpatialSigma * kPatchSpatialSigma) -
                   (a - center) * (a - center) /
                       (2. * kPatchColorSigma * kPatchColorSigma));
      sum_weight += w;
      sum_a += w * a;
      sum_b += w * b;
      sum_aa += w * a * a;
      sum_bb += w * b * b;
      sum_ab += w * a * b;
    }
  }
  const double mean_a = sum_a / sum_weight;
  const double mean_b = sum_b / sum_weight;
  const double variance_a = sum_aa / sum_weight - mean_a * mean_a;
  const double variance_b = sum_bb / sum_weight - mean_b * mean_b;
  if (variance_a < kMinVariance || variance_b < kMinVariance) {
    return kUndefinedCost;
  }
  const double covariance = sum_ab / sum_weight - mean_a * mean_b;
  return std::clamp(
      1. - covariance / std::sqrt(variance_a * variance_b), 0., 2.);
}

// The smallest and second smallest defined value.
struct TwoSmallest {
  double first = kUndefinedCost;
  double second = kUndefinedCost;

  void Add(double cost) {
    if (cost == kUndefinedCost) {
      return;
    }
    if (first == kUndefinedCost || cost < first) {
      second = first;
      first = cost;
    } else if (second == kUndefinedCost || cost < second) {
      second = cost;
    }
  }
};

// How one kind of computed costs compares with the exported ones.
class Comparison {
 public:
  void Add(double exported, double computed) {
    if (exported == kUndefinedCost || computed == kUndefinedCost) {
      only_exported_ += exported != kUndefinedCost;
      only_computed_ += computed != kUndefinedCost;
      return;
    }
    differences_.push_back(computed - exported);
  }

  void Print(const std::string& name) {
    const double count = std::max<double>(1, differences_.size());
    double mean = 0;
    double within = 0;
    for (double& difference : differences_) {
      mean += difference / count;
      difference = std::abs(difference);
      within += (difference < 0.01) / count;
    }
    std::sort(differences_.begin(), differences_.end());
    const auto quantile = [&](double q) {
      return differences_.empty()
                 ? 0.
                 : differences_[q *
                                static_cast<double>(differences_.size() - 1)];
    };
    std::printf("%-28s %9zu %8.4f %8.4f %8.4f %8.4f %8.3f %9ld %9ld\n",
                name.c_str(),
                differences_.size(),
                mean,
                quantile(.5),
                quantile(.9),
                quantile(.99),
                within,
                only_exported_,
                only_computed_);
  }

 private:
  std::vector<double> differences_;
  long only_exported_ = 0;
  long only_computed_ = 0;
};

// By the way in which costs are computed: as tsar_refine does, with all pixels
// of the window, and with images like those that COLMAP reads as well.
struct Comparisons {
  Comparison sampled;
  Comparison full;
  Comparison alike;
};

bool HasExportedCosts(const Workspace& workspace, MapType type) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  return std::any_of(
      problems.begin(), problems.end(), [&](const StereoProblem& problem) {
        return std::filesystem::exists(
            workspace.Paths(problem.reference, type).cost);
      });
}

// Compares the costs of one pixel with all pixels of the window. grays: the
// images as COLMAP reads them, by index in the sparse model.
void CompareFullWindows(const StereoProblem& problem,
                        const ViewData& view,
                        const ReferenceView& reference,
                        const std::vector<SourceView>& sources,
                        const std::vector<Image<float>>& grays,
                        int x,
                        int y,
                        Comparisons* comparisons) {
  const Plane plane = Plane::FromPoint(
      reference.intrinsics.Ray(x, y), view.depth(x, y), view.normal(x, y));
  const auto colmap_sampler = [&](int image) {
    return [gray = grays[image].View()](float u, float v) {
      return SampleInBlack(gray, u, v);
    };
  };
  TwoSmallest full;
  TwoSmallest alike;
  for (size_t i = 0; i < sources.size(); ++i) {
    const SourceView& source = sources[i];
    const PlaneHomography homography(
        reference.intrinsics, source.intrinsics, source.from_reference, plane);
    full.Add(FullWindowCost(
        [&](float u, float v) {
          return SampleGray(reference.gray, u + 0.5f, v + 0.5f);
        },
        [&](float u, float v) {
          return SampleGray(source.gray, u + 0.5f, v + 0.5f);
        },
        homography,
        x,
        y));
    alike.Add(FullWindowCost(colmap_sampler(problem.reference),
                             colmap_sampler(problem.sources[i]),
                             homography,
                             x,
                             y));
  }
  comparisons->full.Add(view.min_cost(x, y), full.first);
  comparisons->alike.Add(view.min_cost(x, y), alike.first);
}

void CompareView(const StereoProblem& problem,
                 const std::vector<ViewData>& views,
                 const std::vector<Image<float>>& grays,
                 Device& device,
                 Comparisons* comparisons) {
  const ViewData& view = views[problem.reference];
  std::vector<const ViewData*> sources;
  for (const int source : problem.sources) {
    sources.push_back(&views[source]);
  }
  const DeviceViews on_device(view, UploadViews(sources, device), device);
  const MatchingCosts costs =
      ComputeMatchingCosts(on_device.Reference(), on_device.Sources(), device);
  const Image<float> first = costs.min_cost.ToHost();
  const std::vector<SourceView> source_views = on_device.Sources().Host();
  for (int y = 0; y < view.depth.Height(); y += kStride) {
    for (int x = 0; x < view.depth.Width(); x += kStride) {
      if (view.depth(x, y) > 0.f) {
        comparisons->sampled.Add(view.min_cost(x, y), first(x, y));
        CompareFullWindows(problem,
                           view,
                           on_device.Reference(),
                           source_views,
                           grays,
                           x,
                           y,
                           comparisons);
      }
    }
  }
}

void Study(const std::string& root, MapType type) {
  const Workspace workspace(root, type);
  if (!HasExportedCosts(workspace, type)) {
    return;
  }
  const std::unique_ptr<Device> device = Device::CreateCpu(0);
  std::vector<ViewData> views;
  std::vector<Image<float>> grays;
  for (size_t i = 0; i < workspace.Model().images.size(); ++i) {
    views.push_back(LoadView(workspace, static_cast<int>(i)));
    grays.push_back(ColmapGray(views.back().color));
  }
  Comparisons comparisons;
  for (const StereoProblem& problem : workspace.Problems()) {
    if (views[problem.reference].min_cost.Empty()) {
      throw Error::File(ErrorCode::kNotFound,
                        workspace.Paths(problem.reference, type).cost.string(),
                        "is missing",
                        "write it with --PatchMatchStereo.write_cost_maps 1");
    }
    CompareView(problem, views, grays, *device, &comparisons);
  }
  std::printf("%s, %s maps\n", root.c_str(), ToString(type).c_str());
  std::printf("%-28s %9s %8s %8s %8s %8s %8s %9s %9s\n",
              "",
              "pixels",
              "bias",
              "median",
              "90 %",
              "99 %",
              "< 0.01",
              "exported",
              "computed");
  comparisons.sampled.Print("every 2nd row, column");
  comparisons.full.Print("whole window");
  comparisons.alike.Print("and COLMAP's gray");
}

int StudyAll(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: cost_study WORKSPACE [WORKSPACE ...]\n");
    return 2;
  }
  for (int i = 1; i < argc; ++i) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      Study(argv[i], type);
    }
  }
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::StudyAll, argc, argv);
}
