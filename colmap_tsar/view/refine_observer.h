// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The intermediate results of refinement that can be looked at, in the order in
// which they come about. "Raster" is that of superpixels and regions; all
// others have the size of the map.
enum class RefineStage {
  kImage,             // Rgb, raster.
  kDepthInput,        // float, depth; so are all depths below.
  kNormalsInput,      // Vec3f
  kCost,              // float, [0, 2]
  kMatchConfidence,   // float, [0, 1]
  kAgreement,         // uint8_t, number of sources.
  kDiscontinuity,     // float, [0, 11/6]
  kScore,             // float, about [0, 1].
  kDepthReliable,     // float
  kSuperpixels,       // int, labels, raster.
  kDepthTrusted,      // float
  kSuperpixelPlanes,  // Plane, raster.
  kEdges,             // uint8_t, other than 0 on edges, raster.
  kLines,             // As the edges.
  kRegions,           // int, labels, -1 outside of regions, raster.
  kRegionPlanes,      // Plane, raster.
  kSceneLabels,       // int, number of the surface or -1, raster.
  kLabelEvidence,     // uint8_t, values of LabelEvidence, raster.
  kScenePlanes,       // Plane, raster.
  kDepthComposed,     // float
  kDepth,             // float
  kNormals,           // Vec3f
  kProvenance,        // uint8_t, values of Provenance.
  kConfidence,        // float, [0, 1]
};

struct RefineStageInfo {
  RefineStage stage;
  std::string name;  // Lower case, with underscores.
  std::string description;
};

// All of them, element i about the stage with value i.
const std::vector<RefineStageInfo>& RefineStages();

// Is shown what the stages find for one image. A stage that the options switch
// off shows nothing. Called from one thread at a time.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void Show(RefineStage stage, const Image<Rgb>& colors) = 0;
  virtual void Show(RefineStage stage, const Image<float>& values) = 0;
  virtual void Show(RefineStage stage, const Image<Vec3f>& normals) = 0;
  virtual void Show(RefineStage stage, const Image<uint8_t>& values) = 0;
  virtual void Show(RefineStage stage, const Image<int>& labels) = 0;
  virtual void Show(RefineStage stage, const Image<Plane>& planes) = 0;
};

// Gives every image of a run an observer.
class RefineObserver {
 public:
  virtual ~RefineObserver() = default;

  // The observer of one pass over the image; a run may take two, with other
  // stages each. depth: the map before. Called from several threads.
  virtual std::unique_ptr<StageObserver> Observe(const std::string& image_name,
                                                 const Image<float>& depth) = 0;
};

// Shows what lies in a device's memory. Without an observer, or where there is
// nothing, this costs nothing.
template <typename T>
void ShowStage(StageObserver* observer,
               RefineStage stage,
               ImageView<const T> values,
               Device& device) {
  if (observer != nullptr && !values.Empty()) {
    Image<T> host = Image<T>::Uninitialized(values.width, values.height);
    device.CopyToHost(host.Data(), values.data, host.NumPixels() * sizeof(T));
    observer->Show(stage, host);
  }
}
template <typename T>
void ShowStage(StageObserver* observer,
               RefineStage stage,
               const DeviceImage<T>& values,
               Device& device) {
  ShowStage(observer, stage, values.View(), device);
}

// The depth where the mask is not 0.
void ShowMaskedDepth(StageObserver* observer,
                     RefineStage stage,
                     ImageView<const float> depth,
                     ImageView<const uint8_t> mask,
                     Device& device);

}  // namespace tsar
