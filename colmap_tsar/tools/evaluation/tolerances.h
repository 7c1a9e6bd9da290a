// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// Throws Error kBadOption unless the tolerances are positive, finite, ascending
// and at least one.
void CheckTolerances(const std::vector<double>& tolerances);

// Parses a list such as "0.02,0.1". Throws Error kBadOption for other texts.
std::vector<double> ParseTolerances(const std::string& text);

// 2ab / (a + b), and 0 where both are 0: the F1 score of two shares.
double HarmonicMean(double a, double b);

}  // namespace tsar
