// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/tools/plane_export/exported_planes.h"

namespace tsar {

// The axis of the written coordinates that points up.
enum class UpAxis {
  kModel,  // Whichever it is in the sparse model.
  kY,
  kZ,
};

inline constexpr EnumNames<UpAxis, 3> kUpAxisNames = {
    {{UpAxis::kModel, "model"}, {UpAxis::kY, "y"}, {UpAxis::kZ, "z"}}};

// Turns planes about the origin until the vertical is this axis: for z the
// shortest way; for y then (x, y, z) becomes (x, z, -y), as programs convert
// files with y up, so that all files of a scene have the same heading. Throws Error kUnsupported where there is no vertical.
void TurnUp(UpAxis axis, ExportedPlanes* planes);

// Makes all lengths meters. meters_per_unit: > 0, of a unit of the sparse
// model.
void ScaleToMeters(double meters_per_unit, ExportedPlanes* planes);

}  // namespace tsar
