// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// How a raster is brought to another size: averaging for photos; picking for
// maps, whose values must not be mixed.
enum class Scaling { kAverage, kPick };

}  // namespace tsar
