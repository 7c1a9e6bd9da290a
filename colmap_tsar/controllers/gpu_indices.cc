// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/gpu_indices.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace tsar {
namespace {

Error Refused(const std::string& what) {
  return Error(ErrorCode::kBadOption,
               OptionName("gpu_index") + ": " + what +
                   "; give -1 for every GPU, or numbers from 0 on such as 0,1");
}

int ParseIndex(const std::string& word, const std::string& text) {
  const size_t begin = word.find_first_not_of(' ');
  const std::string number =
      begin == std::string::npos
          ? ""
          : word.substr(begin, word.find_last_not_of(' ') - begin + 1);
  int index = -1;
  const char* end = number.data() + number.size();
  const auto result = std::from_chars(number.data(), end, index);
  if (result.ptr != end || result.ec != std::errc()) {
    throw Refused("'" + text + "' is not a list of GPUs");
  }
  if (index < 0) {
    throw Refused("there is no GPU " + number);
  }
  return index;
}

}  // namespace

std::vector<int> ParseGpuIndices(const std::string& text) {
  std::vector<int> indices;
  if (text == "-1") {
    return indices;
  }
  // A word for the end of the text also where that is empty.
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    const int index = ParseIndex(word, text);
    if (std::find(indices.begin(), indices.end(), index) != indices.end()) {
      throw Refused("GPU " + std::to_string(index) + " is named twice");
    }
    indices.push_back(index);
  }
  return indices;
}

}  // namespace tsar
