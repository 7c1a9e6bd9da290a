// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/model_scene.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cuda/cuda_test.h"
#include "tests/cuda/observed_room.h"

namespace tsar {
namespace {

// All views of the room are sources of each other.
std::vector<SceneView> ViewsOf(const SyntheticRoom& room) {
  std::vector<SceneView> views;
  for (size_t i = 0; i < room.cameras.size(); ++i) {
    SceneView view;
    view.image = static_cast<int>(i);
    view.camera = room.cameras[i];
    for (size_t j = 0; j < room.cameras.size(); ++j) {
      if (j != i) {
        view.sources.push_back(j);
      }
    }
    views.push_back(view);
  }
  return views;
}

StageResult NumbersOf(const SceneModel& model) {
  StageResult result;
  for (const auto& [image, labels] : model.views) {
    result.Add("planes of view " + std::to_string(image), labels.planes);
    result.Add("evidence of view " + std::to_string(image), labels.evidence);
    result.Add("qualities of view " + std::to_string(image), labels.qualities);
  }
  return result;
}

// Two threads that share two devices of a GPU, with costs that are kept from
// sweep to sweep and with costs that are not, in each of three sweeps.
TEST_F(CudaTest, ModelScene) {
  const SyntheticRoom room = RoomWithADisc();
  std::vector<ViewEvidence> evidence = ObserveInPart(room);
  for (size_t i = 0; i < evidence.size(); ++i) {
    // An image of one brightness: no crease is found in it.
    evidence[i].color = Image<Rgb>(
        room.cameras[i].width, room.cameras[i].height, Rgb{100, 100, 100});
    evidence[i].confident_depth =
        Image<float>(room.cameras[i].width, room.cameras[i].height, 0.f);
    for (const WorldPlane& plane : room.Candidates()) {
      evidence[i].candidates.push_back(ToCameraPlane(plane, room.cameras[i]));
    }
  }
  const SceneEvidence source = {
      [&](size_t view) {
        return std::make_shared<const ViewEvidence>(evidence[view]);
      },
      [&](size_t view) { return evidence[view]; }};
  const auto run = [&](const ModelResources& resources) {
    std::ostringstream text;
    Progress progress(text, false);
    return *ModelScene({ViewsOf(room),
                        source,
                        RefineOptions(),
                        ModelSceneOptions(),
                        resources,
                        progress,
                        [] { return false; }});
  };
  ModelResources resources;
  resources.num_threads = 2;
  resources.num_views = 2;
  const SceneModel on_cpu = run(resources);
  // Something is there to be compared.
  for (const auto& [image, labels] : on_cpu.views) {
    EXPECT_GT(std::set<int>(labels.planes.begin(), labels.planes.end()).size(),
              2u)
        << image;
  }
  const std::unique_ptr<Device> other = Device::CreateCuda(0);
  resources.gpus = {{"GPU 0", cuda_.get()}, {"GPU 0", other.get()}};
  resources.max_gpu_bytes = int64_t{1} << 30;
  for (const int64_t max_kept_bytes : {int64_t{0}, int64_t{1} << 30}) {
    resources.max_kept_bytes = max_kept_bytes;
    EXPECT_EQ(FindDifferences(NumbersOf(on_cpu), NumbersOf(run(resources))), "")
        << max_kept_bytes;
  }
  EXPECT_GT(cuda_->PeakMemory(), 0u);
}

}  // namespace
}  // namespace tsar
