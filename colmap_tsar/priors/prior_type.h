// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/priors/depth_prior.h"

#include <string>

namespace tsar {

// "auto", "metric", "relative" or "inverse".
std::string ToString(PriorType type);

// Throws Error kBadOption, naming the option prior_type, for any other text.
PriorType ParsePriorType(const std::string& text);

}  // namespace tsar
