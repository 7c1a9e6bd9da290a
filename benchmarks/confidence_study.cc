// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Which measure tells right depths from wrong ones? For each workspace with
// ground truth, prints the area under the ROC curve of every term of the
// filters and of their sums, and the precision at fixed recalls, where 'right'
// means within 2 cm of the truth.
//
//   confidence_study WORKSPACE [WORKSPACE ...]

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/modeled_scene.h"

namespace tsar {
namespace {

struct Sample {
  float score;
  bool right;
};

// Ties count half.
double AreaUnderRoc(std::vector<Sample> samples) {
  std::sort(samples.begin(),
            samples.end(),
            [](const Sample& a, const Sample& b) { return a.score < b.score; });
  double area = 0;
  double wrong_below = 0;
  double num_right = 0;
  for (size_t i = 0; i < samples.size();) {
    size_t j = i;
    double right = 0;
    double wrong = 0;
    for (; j < samples.size() && samples[j].score == samples[i].score; ++j) {
      (samples[j].right ? right : wrong) += 1;
    }
    area += right * (wrong_below + 0.5 * wrong);
    wrong_below += wrong;
    num_right += right;
    i = j;
  }
  return area / std::max(1.0, num_right * wrong_below);
}

double PrecisionAtRecall(std::vector<Sample> samples, double recall) {
  std::sort(samples.begin(),
            samples.end(),
            [](const Sample& a, const Sample& b) { return a.score > b.score; });
  double num_right = 0;
  for (const Sample& sample : samples) {
    num_right += sample.right;
  }
  double found = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    found += samples[i].right;
    const bool end_of_tie =
        i + 1 == samples.size() || samples[i + 1].score != samples[i].score;
    if (end_of_tie && found >= recall * num_right) {
      return found / (i + 1);
    }
  }
  return 0;
}

using Table = std::map<std::string, std::vector<Sample>>;

void Collect(const Image<float>& score,
             const Image<float>& depth,
             const Image<float>& truth,
             std::vector<Sample>* samples) {
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      const float z = AtSamePlace(truth, x, y, depth);
      if (z > 0.f && depth(x, y) > 0.f) {
        samples->push_back({score(x, y), std::abs(depth(x, y) - z) < 0.02f});
      }
    }
  }
}

// Adds the scores of one view to those of each measure.
void CollectView(const Image<float>& depth_map,
                 const DeviceViews& views,
                 const Image<float>& truth,
                 Device& device,
                 Table* table) {
  const ImageView<const float> depth = views.Hypotheses().depth;
  const MatchingCosts costs =
      ComputeMatchingCosts(views.Reference(), views.Sources(), device);
  const DeviceImage<uint8_t> agreement =
      CountAgreeingSources(views.Reference(), views.Sources(), device);
  const DeviceImage<float> discontinuity =
      ComputeDiscontinuity(depth, views.Scale(), device);
  const auto add = [&](const std::string& name, const Image<float>& score) {
    Collect(score, depth_map, truth, &(*table)[name]);
  };
  const auto negated = [](Image<float> image) {
    for (float& value : image) {
      value = value == kUndefinedCost ? -3.f : -value;
    }
    return image;
  };
  add("c_min", negated(costs.min_cost.ToHost()));
  add("LRD", negated(costs.left_right_difference.ToHost()));
  Image<float> counts(views.Width(), views.Height());
  std::ranges::copy(agreement.ToHost(), counts.begin());
  add("agreeing views", counts);
  add("n_disp", discontinuity.ToHost());
  const DeviceImage<float> confidence = ComputeConfidence(costs, device);
  const auto aggregate = [&](ImageView<const uint8_t> counted) {
    return AggregateScores(depth,
                           confidence.View(),
                           discontinuity.View(),
                           counted,
                           {},
                           device)
        .ToHost();
  };
  add("n_cost", confidence.ToHost());
  add("n_aggr", aggregate({}));
  add("n_aggr + views", aggregate(agreement.View()));
}

void PrintMeasures(const Table& table) {
  std::printf("%-46s %6s  %s\n", "", "AUC", "precision at recall .3 .5 .7 .9");
  for (const auto& [name, samples] : table) {
    std::printf("%-46s %6.3f  %.3f %.3f %.3f %.3f\n",
                name.c_str(),
                AreaUnderRoc(samples),
                PrecisionAtRecall(samples, 0.3),
                PrecisionAtRecall(samples, 0.5),
                PrecisionAtRecall(samples, 0.7),
                PrecisionAtRecall(samples, 0.9));
  }
}

void PrintThresholds(const char* name, const std::vector<Sample>& samples) {
  for (const float eta : {0.4f, 0.6f, 0.7f, 0.8f, 0.9f, 1.f, 1.2f}) {
    double kept = 0;
    double kept_right = 0;
    double right = 0;
    for (const Sample& sample : samples) {
      right += sample.right;
      kept += sample.score > eta;
      kept_right += sample.score > eta && sample.right;
    }
    std::printf("%s > %.1f: precision %.3f recall %.3f\n",
                name,
                eta,
                kept_right / std::max(kept, 1.0),
                kept_right / std::max(right, 1.0));
  }
}

void Study(const std::string& root) {
  const Workspace workspace(root, MapType::kPhotometric);
  const std::unique_ptr<Device> device = Device::CreateCpu(0);
  std::vector<ViewData> views;
  for (size_t i = 0; i < workspace.Model().images.size(); ++i) {
    views.push_back(LoadView(workspace, static_cast<int>(i)));
  }
  Table table;
  for (const StereoProblem& problem : workspace.Problems()) {
    std::vector<const ViewData*> sources;
    for (const int source : problem.sources) {
      sources.push_back(&views[source]);
    }
    const ViewData& view = views[problem.reference];
    const std::string& name = workspace.Model().images[problem.reference].name;
    CollectView(view.depth,
                DeviceViews(view, UploadViews(sources, *device), *device),
                ReadDepthMap(workspace.Root() / "ground_truth" / "depth" /
                             (name + ".bin")),
                *device,
                &table);
  }
  std::printf("%s, photometric maps, right = within 2 cm\n", root.c_str());
  PrintMeasures(table);
  for (const char* name : {"n_aggr, no ratio", "n_aggr + views, no ratio"}) {
    PrintThresholds(name, table[name]);
  }
}

int StudyAll(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    Study(argv[i]);
  }
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::StudyAll, argc, argv);
}
