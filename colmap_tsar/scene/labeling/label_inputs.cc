// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/label_inputs.h"

#include "colmap_tsar/base/image.h"

#include <cstddef>
#include <numeric>

namespace tsar {
namespace {

PixelGroups GroupBySuperpixel(const ViewEvidence& evidence, Device& device) {
  std::vector<int> labels(evidence.NumSuperpixels());
  std::iota(labels.begin(), labels.end(), 0);
  return GroupByLabel(evidence, labels, evidence.NumSuperpixels(), device);
}

}  // namespace

PixelGroups GroupByLabel(const ViewEvidence& evidence,
                         const std::vector<int>& labels,
                         int num_labels,
                         Device& device) {
  Image<int> of_pixels =
      Image<int>::Uninitialized(evidence.width, evidence.height);
  for (size_t i = 0; i < of_pixels.NumPixels(); ++i) {
    of_pixels.Data()[i] = labels[evidence.superpixels.Data()[i]];
  }
  return GroupPixels(
      DeviceImage<int>(device, of_pixels).View(), num_labels, device);
}

LabelInputs::LabelInputs(const std::vector<ObservedView>& views,
                         const Rasters& rasters,
                         Device& device)
    : views_(views), pixels_(GroupBySuperpixel(*views[0].evidence, device)) {
  std::vector<ObservedSource> sources;
  for (size_t j = 1; j < views.size(); ++j) {
    const ViewEvidence& evidence = *views[j].evidence;
    sources.push_back(MakeObservedSource(views[0], views[j]));
    if (rasters.confident_depth) {
      confident_depths_.emplace_back(device, evidence.confident_depth);
      sources.back().confident_depth = confident_depths_.back().View();
      colors_.emplace_back(device, evidence.color);
      sources.back().color = colors_.back().View();
      sources.back().gain = EstimateColorGain(views[0], views[j]);
    }
    if (rasters.superpixels) {
      superpixels_.emplace_back(device, evidence.superpixels);
      sources.back().superpixels = superpixels_.back().View();
    }
  }
  sources_ = Buffer<ObservedSource>(device, sources);
}

}  // namespace tsar
