// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_options.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/pipeline/refine_option_list.h"

#include <type_traits>

namespace tsar {
namespace {

template <typename T>
void CheckRange(const RefineField& field, const T* value) {
  if constexpr (!std::is_same_v<T, bool>) {
    // Not the negation, which NaN would pass.
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

RefineOptions RefineOptions::Paper() {
  RefineOptions options;
  options.denoise = false;
  options.view_agreement = false;
  options.confirmed_depths = false;
  options.readmit_filtered = true;
  options.region_cores = false;
  options.max_region_planes = 1;
  options.scene_planes = false;
  options.adjust_planes = false;
  options.pixel_borders = false;
  options.photometric = false;
  options.curved_surfaces = false;
  options.cylinders = false;
  return options;
}

RefineOptions RefineOptions::PaperStrict() {
  RefineOptions options = Paper();
  options.cost_ratio = true;
  options.spread_medians = true;
  options.small_windows = true;
  options.pixel_distances = true;
  options.fill_wide_holes = true;
  options.fill_before_regions = true;
  options.loose_plane_tolerance = 5e-3;
  options.edges_of_roots = true;
  options.short_lines = true;
  options.region_rims = false;
  options.bounded_regions = false;
  options.max_boundary_gap = 0.1;
  return options;
}

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
