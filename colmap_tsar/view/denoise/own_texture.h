// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// A pixel's own texture is the variance of the gray levels, of 0-255, in the 5
// x 5 pixels around it. Matching windows are wider: without texture of its own
// a pixel takes the depth of any edge in its window.
constexpr int kOwnTextureRadius = 2;

// The least variance of distinct texture. With less, noise and the texture
// nearby move a depth by up to 2 % even where other views agree with it.
constexpr float kDistinctTexture = 64.f;

}  // namespace tsar
