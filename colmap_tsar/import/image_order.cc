// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/image_order.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <set>
#include <system_error>

namespace tsar {
namespace {

std::string Trimmed(const std::string& text) {
  constexpr const char* kBlank = " \t\r\n\v\f";
  const size_t first = text.find_first_not_of(kBlank);
  return first == std::string::npos
             ? ""
             : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The images by their numbers, from a file.
std::vector<int> ReadImageList(const std::filesystem::path& path,
                               const SparseModel& model) {
  InputFile file(path);
  if (!file) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "the list of images is missing or cannot be read (" +
                          file.Reason() + ")",
                      "check " + OptionName("image_list"));
  }
  std::vector<int> images;
  std::set<int> seen;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string name = Trimmed(line);
    if (name.empty()) {
      continue;
    }
    const int image = model.IndexOf(name);
    if (image < 0 || !seen.insert(image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "line " + std::to_string(number) + " names " + name +
                            (image < 0 ? ", which is not in the sparse model"
                                       : " a second time"),
                        "correct the line");
    }
    images.push_back(image);
  }
  if (images.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the list names no image",
                      "write one image name per line");
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
    return ReadImageList(options.image_list, model);
  }
  std::vector<int> images(model.images.size());
  std::iota(images.begin(), images.end(), 0);
  if (options.index_order == IndexOrder::kName) {
    std::sort(images.begin(), images.end(), [&](int a, int b) {
      return model.images[static_cast<size_t>(a)].name <
             model.images[static_cast<size_t>(b)].name;
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
  return order[static_cast<size_t>(number)];
}

}  // namespace tsar
