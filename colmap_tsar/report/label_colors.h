// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// A colour for each label, always the same one; negative labels are black.
Image<Rgb> ColorizeLabels(const Image<int>& labels);

// The image with a bright line along the borders between labels. Both have the
// same size.
Image<Rgb> DrawLabelBorders(const Image<int>& labels, Image<Rgb> image);

}  // namespace tsar
