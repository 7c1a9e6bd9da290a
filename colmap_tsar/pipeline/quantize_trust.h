// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// ViewEvidence::trust: the score of trusted pixels, at most 1, in 255ths and
// rounded up; 0 elsewhere.
DeviceImage<uint8_t> QuantizeTrust(ImageView<const uint8_t> trusted,
                                   ImageView<const float> score,
                                   ImageView<const uint8_t> confirmations,
                                   Device& device);

}  // namespace tsar
