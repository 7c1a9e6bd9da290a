// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/depth_prior.h"

#include "colmap_tsar/base/enum_names.h"

namespace tsar {
namespace {

constexpr EnumNames<PriorType, 4> kNames = {{{PriorType::kAuto, "auto"},
                                             {PriorType::kMetric, "metric"},
                                             {PriorType::kRelative, "relative"},
                                             {PriorType::kInverse, "inverse"}}};

}  // namespace

std::string ToString(PriorType type) { return EnumName(kNames, type); }

}  // namespace tsar
