// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refine_observer.h"

namespace tsar {

const std::vector<RefineStageInfo>& RefineStages() {
  static const std::vector<RefineStageInfo> stages = {
      {RefineStage::kImage, "image", "the image, reduced"},
      {RefineStage::kDepthInput, "depth_input", "depth before"},
      {RefineStage::kNormalsInput, "normals_input", "normals before"},
      {RefineStage::kCost, "cost", "smallest matching cost, 0 to 2"},
      {RefineStage::kMatchConfidence,
       "match_confidence",
       "confidence of the match, 0 to 1"},
      {RefineStage::kAgreement,
       "agreement",
       "sources whose depth agrees, 0 to 4 and more"},
      {RefineStage::kDiscontinuity,
       "discontinuity",
       "size of the smooth surface around a depth, 0 to 1.83"},
      {RefineStage::kScore, "score", "aggregated score, 0 to 1"},
      {RefineStage::kDepthReliable,
       "depth_reliable",
       "depth that the filter lets pass"},
      {RefineStage::kSuperpixels,
       "superpixels",
       "borders of the superpixels over the image"},
      {RefineStage::kDepthTrusted,
       "depth_trusted",
       "depth that its surroundings confirm"},
      {RefineStage::kSuperpixelPlanes,
       "superpixel_planes",
       "normals of the planes of superpixels"},
      {RefineStage::kEdges, "edges", "edges of the image"},
      {RefineStage::kLines, "lines", "edges and the straight lines by them"},
      {RefineStage::kRegions, "regions", "regions without texture"},
      {RefineStage::kRegionPlanes,
       "region_planes",
       "normals of the planes of regions"},
      {RefineStage::kSceneLabels,
       "scene_labels",
       "surfaces of the scene, a color each"},
      {RefineStage::kLabelEvidence,
       "label_evidence",
       "how a surface came there: gray measured, green by other views, purple "
       "guessed"},
      {RefineStage::kScenePlanes,
       "scene_planes",
       "normals of these surfaces within the borders of the image"},
      {RefineStage::kDepthComposed,
       "depth_composed",
       "depth before holes are filled"},
      {RefineStage::kDepth, "depth", "depth after"},
      {RefineStage::kNormals, "normals", "normals after"},
      {RefineStage::kProvenance, "provenance", "where the depth comes from"},
      {RefineStage::kConfidence, "confidence", "confidence after, 0 to 1"},
  };
  return stages;
}

void ShowMaskedDepth(StageObserver* observer,
                     RefineStage stage,
                     ImageView<const float> depth,
                     ImageView<const uint8_t> mask,
                     Device& device) {
  if (observer == nullptr || depth.Empty() || mask.Empty()) {
    return;
  }
  Image<float> shown(depth.width, depth.height);
  Image<uint8_t> kept(mask.width, mask.height);
  device.CopyToHost(
      shown.Data(), depth.data, shown.NumPixels() * sizeof(float));
  device.CopyToHost(kept.Data(), mask.data, kept.NumPixels());
  for (size_t i = 0; i < shown.NumPixels(); ++i) {
    if (kept.Data()[i] == 0) {
      shown.Data()[i] = 0.f;
    }
  }
  observer->Show(stage, shown);
}

}  // namespace tsar
