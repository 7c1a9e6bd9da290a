// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/tolerances.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tsar {

void CheckTolerances(const std::vector<double>& tolerances) {
  if (tolerances.empty() || !(tolerances.front() > 0) ||
      !std::isfinite(tolerances.back()) ||
      std::ranges::adjacent_find(tolerances, std::not_fn(std::less())) !=
          tolerances.end()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("tolerances") +
                    ": must be positive numbers that rise; give a list "
                    "such as 0.02,0.1");
  }
}

std::vector<double> ParseTolerances(const std::string& text) {
  const auto tolerances = ParseNumbers<double>(text);
  if (!tolerances) {
    throw Error(ErrorCode::kBadOption,
                OptionName("tolerances") + ": '" + text +
                    "' is not a list of numbers; give one such as 0.02,0.1");
  }
  CheckTolerances(*tolerances);
  return *tolerances;
}

double HarmonicMean(double a, double b) {
  return a + b > 0 ? 2 * a * b / (a + b) : 0;
}

}  // namespace tsar
