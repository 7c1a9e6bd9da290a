// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/stage_timer.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>

namespace tsar {

// The scores of each hypothesis by the images and the other views.
struct HypothesisScores {
  DeviceImage<float> score;  // n_aggr (Eq. 2), with the agreement of views.
  // The Confirmation of each hypothesis. Empty without
  // RefineOptions::confirmed_depths or view_agreement.
  DeviceImage<uint8_t> confirmations;
};

// The joint hypothesis filtering of the paper, up to its threshold.
HypothesisScores ScoreHypotheses(const ViewData& reference,
                                 const DeviceViews& views,
                                 const RefineOptions& options,
                                 Device& device,
                                 StageTimer* timer,
                                 StageObserver* observer);

}  // namespace tsar
