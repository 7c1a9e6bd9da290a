// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/listed_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/image_list.h"

#include <string>
#include <unordered_map>

namespace tsar {

std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  if (list.empty()) {
    return std::vector<bool>(problems.size(), true);
  }
  std::unordered_map<int, size_t> places;
  for (size_t i = 0; i < problems.size(); ++i) {
    places.emplace(problems[i].reference, i);
  }
  std::vector<bool> is_listed(problems.size());
  for (const ListedImage& listed :
       ReadImageList(list, workspace.Model(), OptionName("image_list_path"))) {
    const auto place = places.find(listed.image);
    if (place == places.end()) {
      throw Error::File(
          ErrorCode::kMismatch,
          list.string(),
          "line " + std::to_string(listed.line) + " names " +
              workspace.Model().images[static_cast<size_t>(listed.image)].name +
              ", which stereo/patch-match.cfg gives no sources",
          "correct the line");
    }
    is_listed[place->second] = true;
  }
  return is_listed;
}

}  // namespace tsar
