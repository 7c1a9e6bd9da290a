// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/model_scene.h"

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
#include "colmap_tsar/scene/label_sweeps.h"
#include "colmap_tsar/scene/scene_options.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <ranges>
#include <utility>

namespace tsar {
namespace {

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
        assignment_(inputs.views.size()) {}

  std::optional<SceneModel> Run() {
    std::vector<Block> blocks = DiscoverBlocks();
    if (inputs_.should_stop()) {
      return std::nullopt;
    }
    Join(std::move(blocks));
    Adjust();
    if (inputs_.should_stop()) {
      return std::nullopt;
    }
    std::optional<std::vector<ViewLabels>> labels = Label();
    if (!labels) {
      return std::nullopt;
    }
    for (size_t i = 0; i < inputs_.views.size(); ++i) {
      model_.views[inputs_.views[i].image] = std::move((*labels)[i]);
    }
    if (inputs_.refine_options.cylinders && !model_.frames.empty()) {
      FindCylinders();
      if (inputs_.should_stop()) {
        return std::nullopt;
      }
    }
    return std::move(model_);
  }

 private:
  struct Block {
    std::vector<size_t> views;
    BlockOfScene found;
  };

  ObservedView Observed(size_t view, const ViewEvidence& evidence) const {
    return MakeObservedView(evidence, inputs_.views[view].camera);
  }

  std::vector<Block> DiscoverBlocks() {
    const std::vector<std::vector<size_t>> parts =
        SplitIntoBlocks(neighbors_, inputs_.options.max_block_views);
    std::vector<std::vector<Block>> found(parts.size());
    inputs_.progress.Start(static_cast<int>(inputs_.views.size()),
                           inputs_.options.progress_prefix + " planes:");
    RunInParallel(parts.size(),
                  inputs_.resources.num_blocks,
                  inputs_.resources.num_threads,
                  [&](size_t i, Device& device) {
                    Discover(parts[i], device, &found[i]);
                  });
    inputs_.progress.Finish();
    std::vector<Block> blocks;
    for (std::vector<Block>& of_part : found) {
      std::move(of_part.begin(), of_part.end(), std::back_inserter(blocks));
    }
    return blocks;
  }

  void Discover(const std::vector<size_t>& part,
                Device& device,
                std::vector<Block>* blocks) {
    if (inputs_.should_stop()) {
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
    blocks->push_back(
        {views, ModelBlock(observed, inputs_.refine_options, device)});
    for (size_t i = 0; i < views.size(); ++i) {
      inputs_.progress.Advance(/*was_work=*/true);
    }
  }

  // Joins the planes of the blocks into those of the model.
  void Join(std::vector<Block> blocks) {
    std::vector<std::vector<size_t>> views;
    for (const Block& block : blocks) {
      views.push_back(block.views);
    }
    const std::vector<std::vector<int>> block_neighbors =
        FindBlockNeighbors(neighbors_, views);
    const std::vector<int> components = FindComponents(neighbors_);
    std::vector<PlaneBlock> planes;
    std::vector<FrameOfBlock> frames;
    for (size_t b = 0; b < blocks.size(); ++b) {
      FrameOfBlock frame;
      frame.component = components[blocks[b].views[0]];
      frame.rotation = blocks[b].found.frame;
      for (const MeasuredScenePlane& plane : blocks[b].found.planes) {
        frame.axes.push_back(plane.found.axis);
        frame.supports.push_back(plane.found.support);
      }
      frames.push_back(std::move(frame));
      planes.push_back({std::move(blocks[b].found.planes), block_neighbors[b]});
    }
    const JoinedPlanes joined =
        JoinPlanes(std::move(planes),
                   inputs_.refine_options.min_scene_plane,
                   *Device::CreateCpu(inputs_.resources.num_threads));
    for (const MeasuredScenePlane& plane : joined.planes) {
      model_.planes.push_back(ToModelPlane(plane));
    }
    for (size_t b = 0; b < blocks.size(); ++b) {
      frames[b].indices = joined.indices[b];
      for (const int plane : joined.indices[b]) {
        model_.planes[plane].component = frames[b].component;
      }
      for (size_t i = 0; i < blocks[b].views.size(); ++i) {
        assignment_[blocks[b].views[i]] = Renumber(
            std::move(blocks[b].found.assignment[i]), joined.indices[b]);
      }
    }
    model_.frames = FindSceneFrames(frames, &model_.planes);
    std::map<int, int> num_blocks;
    for (const FrameOfBlock& frame : frames) {
      ++num_blocks[frame.component];
    }
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
        [&](const std::vector<WorldPlane>& planes) {
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
                        .measuring);
              });
          std::vector<PlaneMeasurement> measurements;
          std::ranges::copy(of_views | std::views::join,
                            std::back_inserter(measurements));
          return measurements;
        },
        may_move_,
        &model_);
  }

  // Labels all views; nothing where the run is to stop.
  std::optional<std::vector<ViewLabels>> Label() {
    LabelSweeps sweeps(inputs_, assignment_, model_.planes);
    const int num_sweeps = inputs_.options.num_sweeps;
    for (int sweep = 0; sweep < num_sweeps; ++sweep) {
      const bool keeps_costs = sweep + 1 < num_sweeps;
      const auto run = [&](const std::string& name) {
        VisitViews("labels " + name, [&](size_t view, Device& cpu) {
          sweeps.LabelView(view, keeps_costs, cpu);
        });
        sweeps.EndSweep();
      };
      run(std::to_string(sweep + 1) + " of " + std::to_string(num_sweeps));
      // The labels of the first sweep are no valid votes beyond creases.
      if (sweep == 0 && inputs_.refine_options.bounding_creases &&
          !inputs_.should_stop() && FindCreases(&sweeps)) {
        run("within creases");
      }
      if (inputs_.should_stop()) {
        return std::nullopt;
      }
    }
    return sweeps.TakeLabels();
  }

  // Finds creases with the labels of the first sweep; the result is invalid
  // where the run is to stop. Returns whether there are any.
  bool FindCreases(LabelSweeps* sweeps) {
    std::vector<Camera> cameras;
    std::vector<const std::vector<int>*> labels;
    for (size_t view = 0; view < inputs_.views.size(); ++view) {
      cameras.push_back(inputs_.views[view].camera);
      labels.push_back(&sweeps->PlanesOf(view));
    }
    const std::vector<int> copies = FindPlaneCopies(model_, cameras, labels);
    std::vector<std::vector<PlaneLine>> of_views(inputs_.views.size());
    ForEachFullView("lines", [&](size_t view, const ObservedView& observed) {
      of_views[view] =
          FindPlaneLines(observed, Renumber(*labels[view], copies), model_);
    });
    const std::vector<SharedLine> lines = JoinPlaneLines(of_views);
    if (lines.empty() || inputs_.should_stop()) {
      return false;
    }
    LineEvidenceSum sum(lines.size());
    std::mutex mutex;
    ForEachFullView("creases", [&](size_t view, const ObservedView& observed) {
      const std::vector<ViewLineEvidence> of_view = TestPlaneLines(
          observed, Renumber(*labels[view], copies), lines, model_);
      const std::lock_guard lock(mutex);
      sum.Add(of_view);
    });
    std::vector<BoundingCrease> creases =
        FindBoundingCreases(lines, sum.Get(), copies, &model_);
    if (creases.empty()) {
      return false;
    }
    sweeps->RestartWithin(std::move(creases));
    return true;
  }

  // The result is invalid where the run is to stop.
  void FindCylinders() {
    CylinderSearch search(model_.frames, neighbors_);
    ForEachFullView("outlines", [&](size_t view, const ObservedView& observed) {
      search.FindOutlines(view, observed);
    });
    if (inputs_.should_stop()) {
      return;
    }
    Visit("circles",
          search.NumAxes(),
          inputs_.resources.num_threads,
          /*are_views=*/false,
          [&](size_t axis, Device& cpu) {
            search.FindCircles(axis, cpu.Threads());
          });
    if (!search.HasFoundAny() || inputs_.should_stop()) {
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
                    if (!inputs_.should_stop()) {
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
};

}  // namespace

std::optional<SceneModel> ModelScene(const ModelSceneInputs& inputs) {
  return SceneModeler(inputs).Run();
}

}  // namespace tsar
