// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/option_name.h"

#include <utility>

namespace tsar {
namespace {

std::function<std::string(const std::string&)>& Namer() {
  static std::function<std::string(const std::string&)> namer;
  return namer;
}

}  // namespace

std::string OptionName(const std::string& key) {
  return Namer() ? Namer()(key) : key;
}

void SetOptionNamer(std::function<std::string(const std::string&)> namer) {
  Namer() = std::move(namer);
}

}  // namespace tsar
