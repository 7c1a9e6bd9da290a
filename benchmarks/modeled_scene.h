// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/compose/occlusion_votes.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/evidence_file.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"
#include "colmap_tsar/scene/find_scene.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The pixel of an image of another size at the same place.
template <typename T>
const T& AtSamePlace(const Image<T>& image,
                     int x,
                     int y,
                     const Image<float>& of) {
  return image(x * image.Width() / of.Width(),
               y * image.Height() / of.Height());
}

// The true depths of an image, which are beside the images: those of an output
// workspace are a link to its input's.
inline Image<float> ReadTruth(const Workspace& workspace,
                              const std::string& image) {
  return ReadDepthMap(
      std::filesystem::canonical(workspace.Root() / "images").parent_path() /
      "ground_truth" / "depth" / (image + ".bin"));
}

// A view of a modeled scene as composition sees it.
struct ModeledImage {
  Image<float> depth;  // Before refinement.
  Image<float> truth;  // The ground truth, of any size.
  DepthResolution resolution;
  float noise = 0.f;  // See ViewEvidence.
  FoundScene found;
  std::vector<ObservedView> views;
  Intrinsics intrinsics;  // For the map.
  Image<uint8_t> flags;
  Image<uint16_t> superpixels;
  Image<float> texture;

  // The index of the superpixel under a pixel of the map.
  size_t SuperpixelAt(int x, int y) const {
    return AtSamePlace(superpixels, x, y, depth);
  }
  LabelMeasures LabelAt(int x, int y) const {
    const LabelQuality& quality = found.labels.qualities[SuperpixelAt(x, y)];
    return {quality.strength.Value(),
            quality.confirmed.Value(),
            quality.uncertainty.Value(),
            quality.margin.Value()};
  }
  MeasurementSupport SupportAt(int x,
                               int y,
                               const OcclusionVotes& votes) const {
    return {votes,
            AtSamePlace(texture, x, y, depth),
            MeasurementFlags::IsTrusted(flags(x, y))};
  }
  Image<OcclusionVotes> CountVotes(const Image<float>& map,
                                   Device& device) const {
    return CountOcclusionVotes({views, found.planes_of_sources},
                               intrinsics,
                               {DeviceImage<float>(device, map).View()},
                               device)[0]
        .ToHost();
  }
};

// A workspace with ground_truth/depth, of maps of at most 1280 pixels, after
// tsar_refine's passes observe and model.
class ModeledScene {
 public:
  explicit ModeledScene(const std::string& root)
      : workspace_(root, MapType::kGeometric),
        model_(ReadSceneModel(GetSceneModelPath(workspace_.Root()))),
        device_(Device::CreateCpu(2)) {
    for (const auto& [image, labels] : model_.views) {
      evidence_[image] = ReadEvidence(
          GetEvidencePath(workspace_.Root(), Name(image), workspace_.Type()));
    }
  }

  const std::filesystem::path& Root() const { return workspace_.Root(); }
  const SceneModel& Model() const { return model_; }
  Device& GetDevice() const { return *device_; }

  // As ComposePass does it, with all other views as sources.
  ModeledImage Load(int image) const {
    ModeledImage result;
    std::vector<ObservedView>& views = result.views;
    views = {Observed(image)};
    std::vector<const ViewLabels*> labels = {&model_.views.at(image)};
    for (const auto& [other, of_other] : model_.views) {
      if (other != image) {
        views.push_back(Observed(other));
        labels.push_back(&of_other);
      }
    }
    result.found = FindScene(views, model_.planes, labels, *device_);
    const ViewData view = LoadView(workspace_, image);
    const ViewEvidence& evidence = evidence_.at(image);
    if (!view.depth.HasSizeOf(evidence.flags)) {
      throw Error(ErrorCode::kMismatch,
                  workspace_.Root().string() +
                      ": maps of more than 1280 pixels; take smaller ones");
    }
    result.resolution = evidence.resolution;
    result.noise = evidence.noise;
    result.intrinsics = view.camera.GetIntrinsics();
    result.depth = view.depth;
    result.truth = ReadTruth(workspace_, Name(image));
    const DeviceImage<Rgb> color(*device_, evidence.color);
    result.flags = evidence.flags;
    result.superpixels = evidence.superpixels;
    result.texture =
        ComputeTexture(ComputeGray(color.View(), *device_).View(), *device_)
            .ToHost();
    return result;
  }

 private:
  const std::string& Name(int image) const {
    return workspace_.Model().images[image].name;
  }

  ObservedView Observed(int image) const {
    return MakeObservedView(evidence_.at(image),
                            workspace_.Model().images[image].camera);
  }

  const Workspace workspace_;
  const SceneModel model_;
  const std::unique_ptr<Device> device_;
  std::map<int, ViewEvidence> evidence_;
};

// Throws kMismatch for the model of a workspace with columns or pipes: there,
// depths that provenance maps call interpolated come from outlines, not from
// interpolation.
inline void RequireNoCylinders(const SceneModel& model,
                               const std::filesystem::path& root) {
  if (!model.cylinders.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      GetSceneModelPath(root).string(),
                      "this scene has columns or pipes, whose depths would "
                      "count as interpolated ones",
                      "refine it with --TsarRefine.cylinders 0");
  }
}

}  // namespace tsar
