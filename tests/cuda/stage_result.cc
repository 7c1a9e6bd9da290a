// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/stage_result.h"

#include <cstring>
#include <sstream>

namespace tsar {
namespace {

std::string FindDifferences(const StageResult::Channel& a,
                            const StageResult::Channel& b) {
  std::ostringstream text;
  if (a.values.size() != b.values.size()) {
    text << a.name << ": " << a.values.size() << " and " << b.values.size()
         << " numbers\n";
    return text.str();
  }
  size_t num_different = 0;
  size_t first = 0;
  for (size_t i = 0; i < a.values.size(); i += a.num_components) {
    for (size_t k = i; k < i + a.num_components; ++k) {
      // Neither 0 and -0 nor a number and NaN are the same.
      if (std::memcmp(&a.values[k], &b.values[k], sizeof(double)) != 0) {
        first = num_different == 0 ? k : first;
        ++num_different;
        break;
      }
    }
  }
  if (num_different > 0) {
    text.precision(9);
    text << a.name << ": " << num_different << " of "
         << a.values.size() / a.num_components
         << " elements differ; the first is number " << first / a.num_components
         << ": " << a.values[first] << " and " << b.values[first] << "\n";
  }
  return text.str();
}

}  // namespace

std::string FindDifferences(const StageResult& a, const StageResult& b) {
  if (a.Channels().size() != b.Channels().size()) {
    return "the numbers of channels differ";
  }
  std::string differences;
  for (size_t i = 0; i < a.Channels().size(); ++i) {
    differences += FindDifferences(a.Channels()[i], b.Channels()[i]);
  }
  return differences;
}

}  // namespace tsar
