// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/depth_prior.h"

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

namespace tsar {
namespace {

constexpr EnumNames<PriorType, 4> kNames = {{{PriorType::kAuto, "auto"},
                                             {PriorType::kMetric, "metric"},
                                             {PriorType::kRelative, "relative"},
                                             {PriorType::kInverse, "inverse"}}};

}  // namespace

std::string ToString(PriorType type) { return EnumName(kNames, type); }

PriorType ParsePriorType(const std::string& text) {
  if (const auto type = FindEnumValue(kNames, text)) {
    return *type;
  }
  throw Error(ErrorCode::kBadOption,
              OptionName("prior_type") + ": '" + text +
                  "' is not known; give auto, metric, relative or inverse");
}

}  // namespace tsar
