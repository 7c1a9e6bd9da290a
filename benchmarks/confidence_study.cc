// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Which measure tells right depths from wrong ones? For each workspace with
// ground truth, prints the area under the ROC curve of every term of the
// filters and of their sums, and the precision at fixed recalls, where 'right'
// means within 2 cm of the truth.
//
//   confidence_study WORKSPACE [WORKSPACE ...]

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/view/filter/confidence.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/gray.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/run_tool.h"

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
      const float z = truth(x * truth.Width() / depth.Width(),
                            y * truth.Height() / depth.Height());
      if (z > 0.f && depth(x, y) > 0.f) {
        samples->push_back({score(x, y), std::abs(depth(x, y) - z) < 0.02f});
      }
    }
  }
}

void Study(const std::string& root) {
  const Workspace workspace(root, MapType::kPhotometric);
  const std::unique_ptr<Device> device = Device::CreateCpu(0);
  std::vector<ViewData> views;
  std::vector<DeviceImage<float>> grays;
  std::vector<DeviceImage<GrayPair>> pairs;
  for (size_t i = 0; i < workspace.Model().images.size(); ++i) {
    views.push_back(LoadView(workspace, static_cast<int>(i)));
    grays.push_back(ComputeGray(views.back().color.View(), *device));
    pairs.push_back(PairGray(std::as_const(grays.back()).View(), *device));
  }
  Table table;
  for (const StereoProblem& problem : workspace.Problems()) {
    const ViewData& view = views[problem.reference];
    const DeviceImage<float>& gray = grays[problem.reference];
    const DeviceImage<float> depth(*device, view.depth);
    const DeviceImage<Vec3f> normal(*device, view.normal);
    const ReferenceView reference{
        view.camera.GetIntrinsics(), gray.View(), depth.View(), normal.View()};
    std::vector<SourceView> sources;
    std::vector<Camera> cameras;
    for (const int s : problem.sources) {
      const ViewData& source = views[s];
      sources.push_back({source.camera.GetIntrinsics(),
                         ComputeRelativePose(view.camera, source.camera),
                         pairs[s].View(),
                         source.depth.View()});
      cameras.push_back(source.camera);
    }
    const Buffer<SourceView> source_buffer(*device, sources);
    const DisparityScale scale = ComputeDisparityScale(view.camera, cameras);
    const MatchingCosts costs =
        ComputeMatchingCosts(reference, source_buffer, *device);
    const DeviceImage<uint8_t> agreement =
        CountAgreeingSources(reference, source_buffer, {}, *device);
    const DeviceImage<float> discontinuity =
        ComputeDiscontinuity(depth.View(), scale, {}, *device);
    const Image<float> truth = ReadDepthMap(
        workspace.Root() / "ground_truth" / "depth" /
        (workspace.Model().images[problem.reference].name + ".bin"));

    const auto add = [&](const std::string& name, const Image<float>& score) {
      Collect(score, view.depth, truth, &table[name]);
    };
    const auto negated = [](Image<float> image) {
      for (float& value : image) {
        value = value == kUndefinedCost ? -3.f : -value;
      }
      return image;
    };
    add("c_min", negated(costs.min_cost.ToHost()));
    add("LRD", negated(costs.left_right_difference.ToHost()));
    Image<float> counts(view.depth.Width(), view.depth.Height());
    const Image<uint8_t> host_agreement = agreement.ToHost();
    std::copy(host_agreement.begin(), host_agreement.end(), counts.begin());
    add("agreeing views", counts);
    add("n_disp", discontinuity.ToHost());
    const std::pair<const char*, ConfidenceOptions> readings[] = {
        {"ratio as printed", {true, true}},
        {"no ratio", {false, true}},
        {"no ratio, no LRD", {false, false}},
    };
    for (const auto& [name, options] : readings) {
      const DeviceImage<float> confidence =
          ComputeConfidence(costs, options, *device);
      add(std::string("n_cost, ") + name, confidence.ToHost());
      add(std::string("n_aggr, ") + name,
          AggregateScores(depth.View(),
                          confidence.View(),
                          discontinuity.View(),
                          {},
                          {},
                          *device)
              .ToHost());
      add(std::string("n_aggr + views, ") + name,
          AggregateScores(depth.View(),
                          confidence.View(),
                          discontinuity.View(),
                          agreement.View(),
                          {},
                          *device)
              .ToHost());
    }
  }
  std::printf("%s, photometric maps, right = within 2 cm\n", root.c_str());
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
  for (const char* name : {"n_aggr, no ratio", "n_aggr + views, no ratio"}) {
    for (const float eta : {0.4f, 0.6f, 0.7f, 0.8f, 0.9f, 1.f, 1.2f}) {
      double kept = 0;
      double kept_right = 0;
      double right = 0;
      for (const Sample& sample : table[name]) {
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
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunTool([&] {
    for (int i = 1; i < argc; ++i) {
      tsar::Study(argv[i]);
    }
  });
}
