// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// Neither NaN nor infinite. Without branches, so that loops over maps become
// vector instructions: what is not finite differs from itself by more than 0.
inline bool IsFinite(float value) { return value - value == 0.f; }

}  // namespace tsar
