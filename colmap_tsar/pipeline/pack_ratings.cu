// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/pack_ratings.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/filtering/confirmation.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

namespace tsar {
namespace {

struct PackRatingsKernel {
  ImageView<const uint8_t> trusted;
  ImageView<const uint8_t> confirmations;
  ImageView<uint8_t> ratings;

  TSAR_HD void operator()(int x, int y) const {
    ratings(x, y) = MeasurementRating::Pack(
        trusted(x, y) != 0,
        confirmations.Empty() ? Confirmation::kNone
                              : static_cast<Confirmation>(confirmations(x, y)));
  }
};

}  // namespace

DeviceImage<uint8_t> PackRatings(ImageView<const uint8_t> trusted,
                                 ImageView<const uint8_t> confirmations,
                                 Device& device) {
  DeviceImage<uint8_t> ratings(device, trusted.width, trusted.height);
  ParallelFor(device,
              trusted.width,
              trusted.height,
              PackRatingsKernel{trusted, confirmations, ratings.View()});
  return ratings;
}

}  // namespace tsar
