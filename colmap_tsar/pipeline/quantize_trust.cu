// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/quantize_trust.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

#include <cmath>

namespace tsar {
namespace {

struct QuantizeTrustKernel {
  ImageView<const uint8_t> trusted;
  ImageView<const float> score;
  ImageView<const uint8_t> confirmations;
  ImageView<uint8_t> trust;

  TSAR_HD void operator()(int x, int y) const {
    trust(x, y) = MeasurementRating::Pack(
        trusted(x, y) != 0,
        confirmations.Empty() ? 0 : confirmations(x, y),
        score(x, y));
  }
};

}  // namespace

DeviceImage<uint8_t> QuantizeTrust(ImageView<const uint8_t> trusted,
                                   ImageView<const float> score,
                                   ImageView<const uint8_t> confirmations,
                                   Device& device) {
  DeviceImage<uint8_t> trust(device, trusted.width, trusted.height);
  ParallelFor(device,
              trusted.width,
              trusted.height,
              QuantizeTrustKernel{trusted, score, confirmations, trust.View()});
  return trust;
}

}  // namespace tsar
