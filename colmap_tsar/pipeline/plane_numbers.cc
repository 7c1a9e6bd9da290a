// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/plane_numbers.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tsar {

Image<uint16_t> PlaneNumbers(const Image<uint16_t>& superpixels,
                             const FoundScene& found) {
  std::vector<uint16_t> of_superpixel;
  for (size_t k = 0; k < found.labeled.labels.size(); ++k) {
    const int label = found.labeled.labels[k];
    const bool is_curved =
        !found.curved.labels.empty() && found.curved.labels[k] >= 0;
    const int number = label >= 0 && !is_curved
                           ? found.plane_numbers[static_cast<size_t>(label)] + 1
                           : 0;
    of_superpixel.push_back(number <= kMaxPlanesOfMap
                                ? static_cast<uint16_t>(number)
                                : uint16_t{0});
  }
  Image<uint16_t> numbers(superpixels.Width(), superpixels.Height());
  std::transform(
      superpixels.begin(),
      superpixels.end(),
      numbers.begin(),
      [&](uint16_t superpixel) { return of_superpixel[superpixel]; });
  return numbers;
}

}  // namespace tsar
