// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// The MeasurementRating of each pixel. trusted: other than 0 where its depth is
// trusted. confirmations: its Confirmation; may be empty.
DeviceImage<uint8_t> PackRatings(ImageView<const uint8_t> trusted,
                                 ImageView<const uint8_t> confirmations,
                                 Device& device);

}  // namespace tsar
