// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refine_options.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <type_traits>
#include <variant>

namespace tsar {
namespace {

template <typename T>
void CheckRange(const RefineField& field, const T* value) {
  if constexpr (!std::is_same_v<T, bool>) {
    // The comparison is not negated, since NaN would pass.
    const bool is_inside = *value >= field.min && *value <= field.max;
    if (!is_inside) {
      TextStream text;
      text << OptionName(field.name) << ": " << *value
           << " makes no sense; give a value from " << field.min << " to "
           << field.max;
      throw Error(ErrorCode::kBadOption, text.str());
    }
  }
}

}  // namespace

void RefineOptions::Check() const {
  if (filter && !filter_confidence && !filter_discontinuity &&
      !view_agreement) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("filter") +
            ": nothing is left to judge depths by; leave "
            "filter_confidence, filter_discontinuity or view_agreement on, "
            "or set filter to 0");
  }
  RefineOptions copy = *this;
  for (const RefineField& field : ListRefineFields(&copy)) {
    std::visit([&](const auto* value) { CheckRange(field, value); },
               field.value);
  }
}

}  // namespace tsar
