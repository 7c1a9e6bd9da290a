// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/model_scene.h"

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/adjustment/adjust_planes.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/creases/plane_lines.h"
#include "colmap_tsar/scene/creases/shared_lines.h"
#include "colmap_tsar/scene/discovery/join_planes.h"
#include "colmap_tsar/scene/discovery/manhattan_frame.h"
#include "colmap_tsar/scene/discovery/plane_measurement.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/for_each_view.h"
#include "colmap_tsar/scene/label_sweeps.h"
#include "colmap_tsar/scene/scene_cylinders.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/scene/view_blocks.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

namespace tsar {
namespace {

class SceneModeler {
 public:
  SceneModeler(const std::vector<SceneView>& views,
               const SceneEvidence& evidence,
               const RefineOptions& refine_options,
               const ModelSceneOptions& options,
               const ModelResources& resources,
               Progress& progress,
               const std::function<bool()>& should_stop)
      : views_(views),
        evidence_(evidence),
        refine_options_(refine_options),
        options_(options),
        resources_(resources),
        progress_(progress),
        should_stop_(should_stop),
        neighbors_(MakeViewGraph(views)),
        assignment_(views.size()) {}

  std::optional<SceneModel> Run() {
    std::vector<Block> blocks = DiscoverBlocks();
    if (should_stop_()) {
      return std::nullopt;
    }
    Join(std::move(blocks));
    Adjust();
    if (should_stop_()) {
      return std::nullopt;
    }
    std::optional<std::vector<ViewLabels>> labels = Label();
    if (!labels) {
      return std::nullopt;
    }
    for (size_t i = 0; i < views_.size(); ++i) {
      model_.views[views_[i].image] = std::move((*labels)[i]);
    }
    if (refine_options_.cylinders && !model_.frames.empty()) {
      FindCylinders();
      if (should_stop_()) {
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
    return MakeObservedView(evidence, views_[view].camera);
  }

  std::vector<Block> DiscoverBlocks() {
    const std::vector<std::vector<size_t>> parts =
        SplitIntoBlocks(neighbors_, options_.max_block_views);
    std::vector<std::vector<Block>> found(parts.size());
    progress_.Start(static_cast<int>(views_.size()),
                    options_.progress_prefix + " planes:");
    ForEachView(parts.size(),
                resources_.num_blocks,
                resources_.num_threads,
                [&](size_t i, Device& device) {
                  Discover(parts[i], device, &found[i]);
                });
    progress_.Finish();
    std::vector<Block> blocks;
    for (std::vector<Block>& of_part : found) {
      std::move(of_part.begin(), of_part.end(), std::back_inserter(blocks));
    }
    return blocks;
  }

  void Discover(const std::vector<size_t>& part,
                Device& device,
                std::vector<Block>* blocks) {
    if (should_stop_()) {
      return;
    }
    // The planes found depend slightly on the order of the views.
    std::vector<size_t> views = part;
    std::sort(views.begin(), views.end(), [&](size_t a, size_t b) {
      return views_[a].image < views_[b].image;
    });
    std::vector<std::shared_ptr<const ViewEvidence>> evidence(views.size());
    device.Threads().ForEach(
        views.size(), [&](size_t i) { evidence[i] = evidence_.get(views[i]); });
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
    blocks->push_back({views, ModelBlock(observed, refine_options_, device)});
    for (size_t i = 0; i < views.size(); ++i) {
      progress_.Advance(/*was_work=*/true);
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
                   refine_options_.min_scene_plane,
                   *Device::CreateCpu(resources_.num_threads));
    for (const MeasuredScenePlane& plane : joined.planes) {
      model_.planes.push_back(ToModelPlane(plane));
    }
    for (size_t b = 0; b < blocks.size(); ++b) {
      frames[b].indices = joined.indices[b];
      for (const int plane : joined.indices[b]) {
        model_.planes[static_cast<size_t>(plane)].component =
            frames[b].component;
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
      may_move_.push_back(refine_options_.adjust_planes &&
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
          std::vector<std::vector<PlaneMeasurement>> of_views(views_.size());
          ForEachObservedView(
              "adjustment " + std::to_string(++round),
              [&](size_t view, const ObservedView& observed) {
                of_views[view] = MeasureView(
                    observed,
                    assignment_[view],
                    planes,
                    MakeSceneOptions(refine_options_, {observed}).measuring);
              });
          std::vector<PlaneMeasurement> measurements;
          for (const std::vector<PlaneMeasurement>& of_view : of_views) {
            std::ranges::copy(of_view, std::back_inserter(measurements));
          }
          return measurements;
        },
        may_move_,
        &model_);
  }

  // Labels all views; nothing where the run is to stop.
  std::optional<std::vector<ViewLabels>> Label() {
    LabelSweeps sweeps({views_,
                        evidence_,
                        assignment_,
                        model_.planes,
                        refine_options_,
                        resources_});
    const auto run = [&](int sweep, const std::string& name) {
      progress_.Start(static_cast<int>(views_.size()),
                      options_.progress_prefix + " labels " + name + ":");
      sweeps.Run(sweep + 1 < options_.num_sweeps, progress_, should_stop_);
      progress_.Finish();
      return !should_stop_();
    };
    for (int sweep = 0; sweep < options_.num_sweeps; ++sweep) {
      if (!run(sweep,
               std::to_string(sweep + 1) + " of " +
                   std::to_string(options_.num_sweeps))) {
        return std::nullopt;
      }
      // The labels of the first sweep are no valid votes beyond creases.
      if (sweep == 0 && refine_options_.bounding_creases &&
          FindCreases(&sweeps) && !run(sweep, "within creases")) {
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
    for (size_t view = 0; view < views_.size(); ++view) {
      cameras.push_back(views_[view].camera);
      labels.push_back(&sweeps->PlanesOf(view));
    }
    const std::vector<int> copies =
        FindPlaneCopies(model_, cameras, labels, kCopyTolerance);
    std::vector<std::vector<PlaneLine>> of_views(views_.size());
    ForEachEvidence("lines", [&](size_t view, const ObservedView& observed) {
      of_views[view] =
          FindPlaneLines(observed, Renumber(*labels[view], copies), model_, {});
    });
    const std::vector<SharedLine> lines = JoinPlaneLines(of_views);
    if (lines.empty() || should_stop_()) {
      return false;
    }
    LineEvidenceSum sum(lines.size());
    std::mutex mutex;
    ForEachEvidence("creases", [&](size_t view, const ObservedView& observed) {
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
    sweeps->Bound(std::move(creases));
    return true;
  }

  // The result is invalid where the run is to stop.
  void FindCylinders() {
    CylinderSearch search(model_.frames, neighbors_);
    ForEachEvidence("outlines", [&](size_t view, const ObservedView& observed) {
      search.FindOutlines(view, observed);
    });
    if (should_stop_()) {
      return;
    }
    Visit("circles",
          search.NumAxes(),
          resources_.num_threads,
          /*are_views=*/false,
          [&](size_t axis, Device& cpu) {
            search.FindCircles(axis, cpu.Threads());
          });
    if (!search.HasFoundAny() || should_stop_()) {
      return;
    }
    ForEachObservedView(
        "columns", [&](size_t view, const ObservedView& observed) {
          search.Test(
              observed, model_.planes, model_.views.at(views_[view].image));
        });
    model_.cylinders = search.Result();
  }

  using OfView = std::function<void(size_t view, const ObservedView&)>;

  // Calls function for all views, with the parts of their evidence that
  // neighbors need.
  void ForEachObservedView(const std::string& name, const OfView& function) {
    VisitViews(name, [&](size_t view) {
      function(view, Observed(view, *evidence_.get(view)));
    });
  }

  // The same with all parts.
  void ForEachEvidence(const std::string& name, const OfView& function) {
    VisitViews(name, [&](size_t view) {
      function(view, Observed(view, evidence_.read_all(view)));
    });
  }

  // Calls function for all views, unless the run is to stop.
  void VisitViews(const std::string& name,
                  const std::function<void(size_t view)>& function) {
    Visit(name,
          views_.size(),
          resources_.num_views,
          /*are_views=*/true,
          [&](size_t view, Device&) { function(view); });
  }

  void Visit(const std::string& name,
             size_t count,
             int max_at_a_time,
             bool are_views,
             const std::function<void(size_t i, Device& cpu)>& function) {
    progress_.Start(static_cast<int>(count),
                    options_.progress_prefix + " " + name + ":");
    ForEachView(count,
                max_at_a_time,
                resources_.num_threads,
                [&](size_t i, Device& cpu) {
                  if (!should_stop_()) {
                    function(i, cpu);
                    // The speed that progress reports is in images.
                    progress_.Advance(/*was_work=*/are_views);
                  }
                });
    progress_.Finish();
  }

  const std::vector<SceneView>& views_;
  const SceneEvidence& evidence_;
  const RefineOptions& refine_options_;
  const ModelSceneOptions options_;
  const ModelResources resources_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const ViewGraph neighbors_;
  // The measured plane of the model by view and superpixel, or -1.
  std::vector<std::vector<int>> assignment_;
  SceneModel model_;
  std::vector<bool> may_move_;  // Per plane, in the adjustment.
};

}  // namespace

std::optional<SceneModel> ModelScene(const std::vector<SceneView>& views,
                                     const SceneEvidence& evidence,
                                     const RefineOptions& refine_options,
                                     const ModelSceneOptions& options,
                                     const ModelResources& resources,
                                     Progress& progress,
                                     const std::function<bool()>& should_stop) {
  return SceneModeler(views,
                      evidence,
                      refine_options,
                      options,
                      resources,
                      progress,
                      should_stop)
      .Run();
}

}  // namespace tsar
