// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/model_scene.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/adjustment/adjust_planes.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/creases/plane_lines.h"
#include "colmap_tsar/scene/creases/shared_lines.h"
#include "colmap_tsar/scene/cylinders.h"
#include "colmap_tsar/scene/discovery/join_planes.h"
#include "colmap_tsar/scene/discovery/manhattan_frame.h"
#include "colmap_tsar/scene/discovery/plane_measurement.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/scene/scene_options.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <ranges>
#include <set>
#include <utility>

namespace tsar {
namespace {

// The least number of views of a plane that nothing measured: color contradicts
// it only where a view compares three others (AddColorCosts).
constexpr int kMinViewsOfGuess = 4;

// Calls function(i, device) for each i in [0, count), max_at_a_time at most in
// parallel. device: the CPU, with an equal share of the threads.
template <typename Function>
void RunInParallel(size_t count,
                   int max_at_a_time,
                   int num_threads,
                   const Function& function) {
  const int at_a_time = std::max(
      1, std::min({max_at_a_time, num_threads, static_cast<int>(count)}));
  ThreadPool pool(at_a_time);
  pool.Run(static_cast<int64_t>(count), [&](int64_t begin, int64_t end) {
    const std::unique_ptr<Device> device =
        Device::CreateCpu(std::max(1, num_threads / at_a_time));
    for (int64_t i = begin; i < end; ++i) {
      function(i, *device);
    }
  });
}

class SceneModeler {
 public:
  explicit SceneModeler(const ModelSceneInputs& inputs)
      : inputs_(inputs),
        neighbors_(MakeViewGraph(inputs.views)),
        assignment_(inputs.views.size()),
        gpus_(inputs.resources.gpus),
        costs_(inputs.views.size()) {}

  std::optional<SceneModel> Run() {
    std::vector<PlaneBlock> blocks = DiscoverBlocks();
    if (inputs_.progress.ShouldStop()) {
      return std::nullopt;
    }
    Join(std::move(blocks));
    Adjust();
    Label();
    if (inputs_.progress.ShouldStop()) {
      return std::nullopt;
    }
    DropUntestedGuesses();
    for (size_t i = 0; i < inputs_.views.size(); ++i) {
      labels_[i].strengths = {};
      model_.views[inputs_.views[i].image] = std::move(labels_[i]);
    }
    if (inputs_.refine_options.cylinders && !model_.frames.empty()) {
      FindCylinders();
    }
    return inputs_.progress.ShouldStop() ? std::nullopt
                                         : std::optional(std::move(model_));
  }

 private:
  ObservedView Observed(size_t view, const ViewEvidence& evidence) const {
    return MakeObservedView(evidence, inputs_.views[view].camera);
  }

  std::vector<PlaneBlock> DiscoverBlocks() {
    const std::vector<std::vector<size_t>> parts =
        SplitIntoBlocks(neighbors_, inputs_.options.max_block_views);
    std::vector<std::vector<PlaneBlock>> found(parts.size());
    inputs_.progress.Start(static_cast<int>(inputs_.views.size()),
                           inputs_.options.progress_prefix + " planes:");
    RunInParallel(parts.size(),
                  inputs_.resources.num_blocks,
                  inputs_.resources.num_threads,
                  [&](size_t i, Device& device) {
                    Discover(parts[i], device, &found[i]);
                  });
    inputs_.progress.Finish();
    std::vector<PlaneBlock> blocks;
    for (std::vector<PlaneBlock>& of_part : found) {
      std::move(of_part.begin(), of_part.end(), std::back_inserter(blocks));
    }
    return blocks;
  }

  void Discover(const std::vector<size_t>& part,
                Device& device,
                std::vector<PlaneBlock>* blocks) {
    if (inputs_.progress.ShouldStop()) {
      return;
    }
    // The planes found depend slightly on the order of the views.
    std::vector<size_t> views = part;
    std::sort(views.begin(), views.end(), [&](size_t a, size_t b) {
      return inputs_.views[a].image < inputs_.views[b].image;
    });
    std::vector<std::shared_ptr<const ViewEvidence>> evidence(views.size());
    device.Threads().ForEach(views.size(), [&](size_t i) {
      evidence[i] = inputs_.evidence.get(views[i]);
    });
    std::vector<ObservedView> observed;
    size_t num_superpixels = 0;
    size_t num_candidates = 0;
    for (size_t i = 0; i < views.size(); ++i) {
      observed.push_back(Observed(views[i], *evidence[i]));
      num_superpixels += evidence[i]->weights.size();
      num_candidates += evidence[i]->candidates.size();
    }
    if (part.size() > 1 && num_superpixels * num_candidates > kMaxBlockScores) {
      // All candidates of fewer views are better than some candidates of these.
      evidence.clear();
      const auto middle =
          part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
      Discover({part.begin(), middle}, device, blocks);
      Discover({middle, part.end()}, device, blocks);
      return;
    }
    blocks->push_back(ModelBlock(observed, inputs_.refine_options, device));
    blocks->back().views = views;
    for (size_t i = 0; i < views.size(); ++i) {
      inputs_.progress.Advance(/*was_work=*/true);
    }
  }

  // Joins the planes of the blocks into those of the model.
  void Join(std::vector<PlaneBlock> blocks) {
    std::vector<std::vector<size_t>> views;
    for (const PlaneBlock& block : blocks) {
      views.push_back(block.views);
    }
    const std::vector<std::vector<int>> block_neighbors =
        FindBlockNeighbors(neighbors_, views);
    const std::vector<int> components = FindComponents(neighbors_);
    std::map<int, int> num_blocks;
    for (size_t b = 0; b < blocks.size(); ++b) {
      blocks[b].neighbors = block_neighbors[b];
      blocks[b].component = components[blocks[b].views[0]];
      ++num_blocks[blocks[b].component];
    }
    const JoinedPlanes joined =
        JoinPlanes(&blocks,
                   inputs_.refine_options.min_scene_plane,
                   *Device::CreateCpu(inputs_.resources.num_threads));
    for (const MeasuredScenePlane& plane : joined.planes) {
      model_.planes.push_back(ToModelPlane(plane));
    }
    for (size_t b = 0; b < blocks.size(); ++b) {
      for (const int plane : joined.indices[b]) {
        model_.planes[plane].component = blocks[b].component;
      }
      for (size_t i = 0; i < blocks[b].views.size(); ++i) {
        assignment_[blocks[b].views[i]] =
            Renumber(std::move(blocks[b].assignment[i]), joined.indices[b]);
      }
    }
    model_.frames = FindSceneFrames(blocks, joined.indices, &model_.planes);
    for (const ModelPlane& plane : model_.planes) {
      may_move_.push_back(inputs_.refine_options.adjust_planes &&
                          num_blocks[plane.component] > 1);
    }
  }

  // Computes the covariances of the model's planes, and adjusts jointly the
  // planes of views that were too many for one block: within a block they are
  // already fitted, by a criterion that is more robust to outliers. Only the
  // measurements of planes are kept, from the evidence of one view at a time.
  void Adjust() {
    int round = 0;
    AdjustModel(
        [&](const std::vector<ModelPlane>& planes) {
          std::vector<std::vector<PlaneMeasurement>> of_views(
              inputs_.views.size());
          ForEachObservedView(
              "adjustment " + std::to_string(++round),
              [&](size_t view, const ObservedView& observed) {
                of_views[view] = MeasureView(
                    observed,
                    assignment_[view],
                    planes,
                    MakeSceneOptions(inputs_.refine_options, {observed})
                        .discovery.tolerance);
              });
          std::vector<PlaneMeasurement> measurements;
          std::ranges::copy(of_views | std::views::join,
                            std::back_inserter(measurements));
          return measurements;
        },
        may_move_,
        &model_);
  }

  // Labels all views in sweeps; the result is invalid where the run is to stop.
  void Label() {
    const int num_sweeps = inputs_.options.num_sweeps;
    for (int sweep = 0; sweep < num_sweeps && !inputs_.progress.ShouldStop();
         ++sweep) {
      const bool keeps_costs = sweep + 1 < num_sweeps;
      Sweep(std::to_string(sweep + 1) + " of " + std::to_string(num_sweeps),
            keeps_costs);
      // The labels of the first sweep are no valid votes beyond creases.
      if (sweep == 0 && inputs_.refine_options.bounding_creases &&
          !inputs_.progress.ShouldStop() && FindCreases()) {
        labels_.clear();
        costs_ = std::vector<Image<PlaneCost>>(costs_.size());
        kept_bytes_ = 0;
        Sweep("within creases", keeps_costs);
      }
    }
  }

  // keeps_costs: keep the costs for another sweep.
  void Sweep(const std::string& name, bool keeps_costs) {
    std::vector<ViewLabels> labels(inputs_.views.size());
    VisitViews("labels " + name, [&](size_t view, Device& cpu) {
      Image<PlaneCost> costs = std::move(costs_[view]);
      const bool were_kept = !costs.Empty();
      labels[view] = LabelView(view, cpu, &costs);
      if (keeps_costs && (were_kept || ReserveMemory(costs))) {
        costs_[view] = std::move(costs);
      }
    });
    labels_ = std::move(labels);
  }

  // cpu: for steps that do not run on GPUs; costs: see LabelInModel.
  ViewLabels LabelView(size_t view, Device& cpu, Image<PlaneCost>* costs) {
    const auto modeled = [&](size_t i, const ViewEvidence& evidence) {
      return ModeledView{Observed(i, evidence),
                         &assignment_[i],
                         labels_.empty() ? nullptr : &labels_[i]};
    };
    const ViewEvidence own = inputs_.evidence.read_all(view);
    std::vector<std::shared_ptr<const ViewEvidence>> others;
    std::vector<ModeledView> views = {modeled(view, own)};
    for (const size_t source : inputs_.views[view].sources) {
      if (source != view) {
        others.push_back(inputs_.evidence.get(source));
        views.push_back(modeled(source, *others.back()));
      }
    }
    const auto lend_device = [&](const std::function<void(Device&)>& work) {
      if (gpus_.Size() > 0) {
        try {
          return gpus_.Run(work);
        } catch (const Error& error) {
          // For this view beside others. The CPU gives the same bits.
          if (error.Code() != ErrorCode::kOutOfMemory) {
            throw;
          }
        }
      }
      work(cpu);
    };
    return LabelInModel(views,
                        model_.planes,
                        creases_,
                        inputs_.refine_options,
                        lend_device,
                        costs);
  }

  // Returns whether the costs may be kept.
  bool ReserveMemory(const Image<PlaneCost>& costs) {
    const auto num_bytes =
        static_cast<int64_t>(costs.NumPixels() * sizeof(PlaneCost));
    if (kept_bytes_.fetch_add(num_bytes) + num_bytes <=
        inputs_.resources.max_kept_bytes) {
      return true;
    }
    kept_bytes_ -= num_bytes;
    return false;
  }

  // Finds creases with the labels of the first sweep; the result is invalid
  // where the run is to stop. Returns whether there are any.
  bool FindCreases() {
    std::vector<Camera> cameras;
    std::vector<const std::vector<int>*> labels;
    for (size_t view = 0; view < inputs_.views.size(); ++view) {
      cameras.push_back(inputs_.views[view].camera);
      labels.push_back(&labels_[view].planes);
    }
    const std::vector<int> copies = FindPlaneCopies(model_, cameras, labels);
    std::vector<std::vector<PlaneProfile>> of_views(inputs_.views.size());
    ForEachFullView("lines", [&](size_t view, const ObservedView& observed) {
      of_views[view] =
          MakePlaneProfiles(observed, Renumber(*labels[view], copies), model_);
    });
    const std::vector<PlaneLine> lines = FindSharedLines(of_views);
    if (lines.empty() || inputs_.progress.ShouldStop()) {
      return false;
    }
    std::vector<LineEvidence> sum(lines.size());
    std::mutex mutex;
    ForEachFullView("creases", [&](size_t view, const ObservedView& observed) {
      const std::vector<LineEvidence> of_view = TestPlaneLines(
          observed, Renumber(*labels[view], copies), lines, model_);
      const std::lock_guard lock(mutex);
      AddEvidence(of_view, &sum);
    });
    creases_ = FindBoundingCreases(lines, sum, copies, &model_);
    return !creases_.empty();
  }

  // Takes planes that begin at creases from views that are too few to test
  // them.
  void DropUntestedGuesses() {
    std::vector<int> num_views(model_.planes.size(), 0);
    for (const ViewLabels& labels : labels_) {
      std::set<int> shown(labels.planes.begin(), labels.planes.end());
      shown.erase(kNoPlane);
      for (const int plane : shown) {
        ++num_views[plane];
      }
    }
    for (ViewLabels& labels : labels_) {
      for (size_t s = 0; s < labels.planes.size(); ++s) {
        if (labels.origins[s] == LabelOrigin::kGuessed &&
            model_.planes[labels.planes[s]].support == 0.0 &&
            num_views[labels.planes[s]] < kMinViewsOfGuess) {
          labels.planes[s] = kNoPlane;
          labels.origins[s] = LabelOrigin::kNone;
          labels.qualities[s] = {};
        }
      }
    }
  }

  // The result is invalid where the run is to stop.
  void FindCylinders() {
    CylinderSearch search(model_.frames, neighbors_);
    ForEachFullView("outlines", [&](size_t view, const ObservedView& observed) {
      search.FindOutlines(view, observed);
    });
    if (inputs_.progress.ShouldStop()) {
      return;
    }
    Visit("circles",
          search.NumAxes(),
          inputs_.resources.num_threads,
          /*are_views=*/false,
          [&](size_t axis, Device& cpu) {
            search.FindCircles(axis, cpu.Threads());
          });
    if (!search.HasFoundAny() || inputs_.progress.ShouldStop()) {
      return;
    }
    ForEachObservedView(
        "columns", [&](size_t view, const ObservedView& observed) {
          search.Test(observed,
                      model_.planes,
                      model_.views.at(inputs_.views[view].image));
        });
    model_.cylinders = search.Result();
  }

  using OfView = std::function<void(size_t view, const ObservedView&)>;

  // Calls function for all views, with the parts of their evidence that
  // neighbors need.
  void ForEachObservedView(const std::string& name, const OfView& function) {
    VisitViews(name, [&](size_t view, Device&) {
      function(view, Observed(view, *inputs_.evidence.get(view)));
    });
  }

  // Calls function for all views, with all parts of their evidence.
  void ForEachFullView(const std::string& name, const OfView& function) {
    VisitViews(name, [&](size_t view, Device&) {
      function(view, Observed(view, inputs_.evidence.read_all(view)));
    });
  }

  using Visitor = std::function<void(size_t i, Device& cpu)>;

  void VisitViews(const std::string& name, const Visitor& visitor) {
    Visit(name,
          inputs_.views.size(),
          inputs_.resources.num_views,
          /*are_views=*/true,
          visitor);
  }

  // Calls visitor for each i in [0, count), unless the run is to stop.
  void Visit(const std::string& name,
             size_t count,
             int max_at_a_time,
             bool are_views,
             const Visitor& visitor) {
    inputs_.progress.Start(static_cast<int>(count),
                           inputs_.options.progress_prefix + " " + name + ":");
    RunInParallel(count,
                  max_at_a_time,
                  inputs_.resources.num_threads,
                  [&](size_t i, Device& cpu) {
                    if (!inputs_.progress.ShouldStop()) {
                      visitor(i, cpu);
                      // The speed that progress reports is in images.
                      inputs_.progress.Advance(/*was_work=*/are_views);
                    }
                  });
    inputs_.progress.Finish();
  }

  const ModelSceneInputs& inputs_;
  const ViewGraph neighbors_;
  // The measured plane of the model by view and superpixel, or -1.
  std::vector<std::vector<int>> assignment_;
  SceneModel model_;
  std::vector<bool> may_move_;  // Per plane, in the adjustment.
  DevicePool gpus_;
  // All sweeps but the first one respect them.
  std::vector<BoundingCrease> creases_;
  // Labels of the last sweep, by view; empty before the first one.
  std::vector<ViewLabels> labels_;
  // Costs by view, constant between sweeps once creases are known; empty
  // without memory for them, in which case they are recomputed.
  std::vector<Image<PlaneCost>> costs_;
  std::atomic<int64_t> kept_bytes_ = 0;
};

}  // namespace

std::optional<SceneModel> ModelScene(const ModelSceneInputs& inputs) {
  return SceneModeler(inputs).Run();
}

}  // namespace tsar
