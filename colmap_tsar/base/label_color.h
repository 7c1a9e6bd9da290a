// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// The fixed color of a label; black for negative labels.
Rgb LabelColor(int label);

}  // namespace tsar
