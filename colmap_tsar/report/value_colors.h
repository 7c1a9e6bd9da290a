// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// Shares of a range: 0 is dark violet, max (and all above) bright yellow, with
// green between them, so that brightness alone tells more from less. Where mask
// is given and 0 there is no value, which is black; it has the size of values.
Image<Rgb> ColorizeValues(const Image<float>& values,
                          float max,
                          const Image<float>* mask = nullptr);

}  // namespace tsar
