// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/option_name.h"

#include <utility>

namespace tsar {
namespace {

std::function<std::string(const std::string&)> namer;

}  // namespace

std::string OptionName(const std::string& key) {
  return namer ? namer(key) : key;
}

void SetOptionNamer(std::function<std::string(const std::string&)> new_namer) {
  namer = std::move(new_namer);
}

}  // namespace tsar
