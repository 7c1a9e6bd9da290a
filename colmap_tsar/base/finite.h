// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// Whether a value is neither NaN nor infinite: x - x is 0 for finite values
// alone. There are no branches, so that loops over maps are vectorized.
inline bool IsFinite(float value) { return value - value == 0.f; }

}  // namespace tsar
