// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/run_summary.h"

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>

namespace tsar {

struct FuseSummary;
struct ImportSummary;
struct RestoreResult;
struct StereoSummary;

// "1 image" or "2 images".
std::string Counted(int64_t count, const std::string& noun);

// Prints for the user what was done, the effect and the time.
void PrintSummary(const RunSummary& summary, std::ostream& out);

// Prints the next command to run, if any.
void PrintNext(const RunSummary& summary, std::ostream& out);

// Prints which maps were put back and which stayed, and the new paths of
// superseded ones.
void PrintSummary(const RestoreResult& result, std::ostream& out);

// Prints the device, the time and images without maps.
void PrintSummary(const StereoSummary& summary, std::ostream& out);

// Prints the next command to run.
void PrintNext(const StereoSummary& summary, std::ostream& out);

// Prints the number of points, the cloud's path and the time.
void PrintSummary(const FuseSummary& summary,
                  const std::filesystem::path& cloud_path,
                  std::ostream& out);

// Prints a few lines for the user, with the next command to run and the first
// of the warnings.
void PrintSummary(const ImportSummary& summary, std::ostream& out);

}  // namespace tsar
