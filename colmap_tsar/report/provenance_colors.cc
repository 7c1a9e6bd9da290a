// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/provenance_colors.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>

namespace tsar {

const std::vector<ProvenanceKind>& ProvenanceKinds() {
  // Colours that also people with colour blindness tell apart (after Okabe and
  // Ito); what was there before stays grey.
  static const std::vector<ProvenanceKind> kinds = {
      {"none", {0, 0, 0}},
      {"measured", {190, 190, 190}},
      {"superpixel plane", {86, 180, 233}},
      {"interpolated", {240, 228, 66}},
      {"region plane", {213, 94, 0}},
      {"other views", {0, 158, 115}},
      {"guessed", {204, 121, 167}},
  };
  return kinds;
}

Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance) {
  const std::vector<ProvenanceKind>& kinds = ProvenanceKinds();
  Image<Rgb> colors(provenance.Width(), provenance.Height());
  std::transform(provenance.begin(),
                 provenance.end(),
                 colors.begin(),
                 [&kinds](uint8_t value) {
                   if (value >= kinds.size()) {
                     throw Error(ErrorCode::kCorrupt,
                                 "provenance map: unknown value " +
                                     std::to_string(value) +
                                     "; refine the workspace again");
                   }
                   return kinds[value].color;
                 });
  return colors;
}

}  // namespace tsar
