// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/stage_result.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

namespace tsar {
namespace {

bool AreClose(double a, double b, const Closeness& closeness) {
  return a == b ||
         std::abs(a - b) <=
             closeness.absolute +
                 closeness.relative * std::max(std::abs(a), std::abs(b));
}

bool AreSame(double a, double b, const Closeness& /*closeness*/) {
  return std::memcmp(&a, &b, sizeof(a)) == 0;
}

template <typename Equal>
std::string Compare(const StageResult& a,
                    const StageResult& b,
                    bool allow_some,
                    const Equal& equal) {
  std::ostringstream text;
  if (a.Channels().size() != b.Channels().size()) {
    return "the numbers of channels differ";
  }
  for (size_t c = 0; c < a.Channels().size(); ++c) {
    const StageResult::Channel& x = a.Channels()[c];
    const StageResult::Channel& y = b.Channels()[c];
    if (x.values.size() != y.values.size()) {
      text << x.name << ": " << x.values.size() << " and " << y.values.size()
           << " numbers\n";
      continue;
    }
    const size_t count = x.values.size() / x.num_components;
    size_t num_different = 0;
    size_t first = 0;
    for (size_t i = 0; i < x.values.size(); i += x.num_components) {
      for (size_t k = i; k < i + x.num_components; ++k) {
        if (!equal(x.values[k], y.values[k], x.closeness)) {
          first = num_different == 0 ? k : first;
          ++num_different;
          break;
        }
      }
    }
    const double max_share = allow_some ? x.closeness.max_share : 0.0;
    if (num_different > max_share * static_cast<double>(count)) {
      text.precision(9);
      text << x.name << ": " << num_different << " of " << count
           << " elements differ; the first is number "
           << first / x.num_components << ": " << x.values[first] << " and "
           << y.values[first] << "\n";
    }
  }
  return text.str();
}

}  // namespace

std::string FindDifferences(const StageResult& a, const StageResult& b) {
  return Compare(a, b, true, AreClose);
}

std::string FindDifferentBytes(const StageResult& a, const StageResult& b) {
  return Compare(a, b, false, AreSame);
}

}  // namespace tsar
