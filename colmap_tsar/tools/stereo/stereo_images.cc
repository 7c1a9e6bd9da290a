// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_images.h"

#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <optional>

namespace tsar {

std::vector<std::vector<size_t>> FindImagesOfPasses(
    const Workspace& workspace,
    const StereoOptions& options,
    int num_passes,
    const std::vector<bool>& is_listed) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  std::vector<std::optional<size_t>> places(workspace.Model().images.size());
  for (size_t place = 0; place < problems.size(); ++place) {
    places[problems[place].reference] = place;
  }
  std::vector<std::vector<size_t>> images(static_cast<size_t>(num_passes));
  std::vector<bool> is_needed = is_listed;
  for (size_t pass = images.size(); pass-- > 0;) {
    for (size_t place = 0; place < problems.size(); ++place) {
      if (is_needed[place]) {
        images[pass].push_back(place);
      }
    }
    for (const size_t place : images[pass]) {
      for (const int source : StereoSources(problems[place], options)) {
        if (const auto other = places[source]) {
          is_needed[*other] = true;
        }
      }
    }
  }
  return images;
}

}  // namespace tsar
