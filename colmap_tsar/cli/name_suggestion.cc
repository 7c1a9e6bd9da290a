// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/name_suggestion.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tsar {
namespace {

std::string WithoutGroup(const std::string& name) {
  const size_t dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

}  // namespace

int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const int replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::vector<std::string> SuggestNames(const std::string& written,
                                      const std::vector<std::string>& names) {
  const std::string written_tail = WithoutGroup(written);
  const int max_distance =
      std::max(2, static_cast<int>(written_tail.size()) / 3);
  std::vector<std::pair<int, std::string>> candidates;
  for (const std::string& name : names) {
    const int distance =
        std::min(EditDistance(written, name),
                 EditDistance(written_tail, WithoutGroup(name)));
    if (distance <= max_distance) {
      candidates.emplace_back(distance, name);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  if (candidates.size() > 3) {
    candidates.resize(3);
  }
  std::vector<std::string> suggestions;
  suggestions.reserve(candidates.size());
  for (auto& [distance, name] : candidates) {
    suggestions.push_back(std::move(name));
  }
  return suggestions;
}

}  // namespace tsar
