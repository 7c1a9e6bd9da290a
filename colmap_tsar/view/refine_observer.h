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

// The intermediate results of refinement that an observer is shown, in order.
// "Raster" is that of superpixels and regions; all others have the size of the
// map.
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
  kEdges,             // uint8_t, nonzero on edges, raster.
  kLines,             // uint8_t, nonzero on edges, raster.
  kRegions,           // int, labels, -1 outside of regions, raster.
  kRegionPlanes,      // Plane, raster.
  kSceneLabels,       // int, index of the surface or -1, raster.
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

// All stages; element i describes the stage of value i.
const std::vector<RefineStageInfo>& RefineStages();

// Receives the results of the stages for one image. A disabled stage shows
// nothing. Called from one thread at a time.
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

  // Returns the observer of one pass over the image; a run may take two passes
  // with different stages. depth: the original map. Called from several
  // threads.
  virtual std::unique_ptr<StageObserver> Observe(const std::string& image_name,
                                                 const Image<float>& depth) = 0;
};

// Shows a raster in a device's memory. Does nothing without an observer or if
// the raster is empty.
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

// Shows the depth where the mask is nonzero.
void ShowMaskedDepth(StageObserver* observer,
                     RefineStage stage,
                     ImageView<const float> depth,
                     ImageView<const uint8_t> mask,
                     Device& device);

}  // namespace tsar
