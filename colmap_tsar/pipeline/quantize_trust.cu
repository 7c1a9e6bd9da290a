// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/quantize_trust.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

struct QuantizeTrustKernel {
  ImageView<const uint8_t> trusted;
  ImageView<const float> score;
  ImageView<uint8_t> trust;

  TSAR_HD void operator()(int x, int y) const {
    // A trusted pixel keeps its trust, also where nothing judged it.
    const float level = fminf(fmaxf(ceilf(255.f * score(x, y)), 1.f), 255.f);
    trust(x, y) = trusted(x, y) != 0 ? static_cast<uint8_t>(level) : 0;
  }
};

}  // namespace

DeviceImage<uint8_t> QuantizeTrust(ImageView<const uint8_t> trusted,
                                   ImageView<const float> score,
                                   Device& device) {
  DeviceImage<uint8_t> trust(device, trusted.width, trusted.height);
  ParallelFor(device,
              trusted.width,
              trusted.height,
              QuantizeTrustKernel{trusted, score, trust.View()});
  return trust;
}

}  // namespace tsar
