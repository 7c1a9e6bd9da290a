// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Groups the pixels of a view by the label of their superpixel. labels: of each
// superpixel, in [0, num_labels).
PixelGroups GroupByLabel(const ViewEvidence& evidence,
                         const std::vector<int>& labels,
                         int num_labels,
                         Device& device);

// A view to be labeled and its sources, in a device's memory.
class LabelInputs {
 public:
  // The rasters of the sources that are uploaded.
  struct Rasters {
    bool confident_depth = false;  // For ComputePlaneCosts,
    bool superpixels = false;      // and for ComputeLabelVotes.
  };

  // views: the reference, then its sources. Keeps a reference to them.
  LabelInputs(const std::vector<ObservedView>& views,
              const Rasters& rasters,
              Device& device);

  const std::vector<ObservedView>& Views() const { return views_; }
  // The reference's pixels, by superpixel.
  PixelGroupsView Pixels() const { return pixels_.View(); }
  const ObservedSource* Sources() const { return sources_.Data(); }
  int NumSources() const { return static_cast<int>(sources_.Size()); }

 private:
  const std::vector<ObservedView>& views_;
  PixelGroups pixels_;
  std::vector<DeviceImage<float>> confident_depths_;
  std::vector<DeviceImage<Rgb>> colors_;
  std::vector<DeviceImage<uint16_t>> superpixels_;
  Buffer<ObservedSource> sources_;
};

}  // namespace tsar
