// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/image_order.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/image_lists.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <set>
#include <system_error>

namespace tsar {
namespace {

// Reads the images in the order of their indices from a file.
std::vector<int> ReadNumberedImages(const std::filesystem::path& path,
                                    const SparseModel& model) {
  std::vector<int> images;
  std::set<int> seen;
  for (const ListedImage& listed :
       ReadImageList(path, model, OptionName("image_list"))) {
    if (!seen.insert(listed.image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            model.images[listed.image].name + " a second time",
                        "correct the line");
    }
    images.push_back(listed.image);
  }
  return images;
}

}  // namespace

std::optional<int> TrailingNumber(const std::string& name) {
  const size_t last_other = name.find_last_not_of("0123456789");
  const size_t begin = last_other == std::string::npos ? 0 : last_other + 1;
  int number = 0;
  const auto [end, error] =
      std::from_chars(name.data() + begin, name.data() + name.size(), number);
  if (error != std::errc()) {
    return std::nullopt;
  }
  return number;
}

std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model) {
  if (!options.image_list.empty()) {
    return ReadNumberedImages(options.image_list, model);
  }
  std::vector<int> images(model.images.size());
  std::iota(images.begin(), images.end(), 0);
  if (options.index_order == IndexOrder::kName) {
    std::ranges::sort(images, [&](int a, int b) {
      return model.images[a].name < model.images[b].name;
    });
  }
  return images;
}

int ImageOfNumber(const std::vector<int>& order,
                  int number,
                  const std::filesystem::path& path) {
  if (static_cast<size_t>(number) >= order.size()) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "its number is " + std::to_string(number) +
            ", but there are images 0 to " + std::to_string(order.size() - 1) +
            " alone",
        "name the images in their order with " + OptionName("image_list"));
  }
  return order[number];
}

}  // namespace tsar
