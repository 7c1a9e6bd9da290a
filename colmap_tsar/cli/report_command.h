// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/report/write_page.h"

#include <filesystem>
#include <string>

namespace tsar {

// The arguments of tsar_report, from the command line or from Python.
struct ReportCommand {
  std::filesystem::path workspace_path;
  std::string input_type;
  std::filesystem::path prior_path;
  std::string prior_type = "auto";
  std::string fuse;  // A preset of fusion; empty: nothing is fused.
  std::string tolerances = "0.02,0.1";
  int max_points = 300000;
  std::filesystem::path output_path;
  int num_images = 3;
  // The options of the page that the members above do not hold.
  PageOptions page;

  void AddTo(OptionSet* options);

  // Throws kBadOption where an option of the page is given for a picture alone.
  void Check() const;

  // Opens the workspace with the requested maps, and with the depth priors.
  // Throws what Workspace throws.
  Workspace Open() const;

  bool WantsPicture() const { return !output_path.empty(); }
  bool WantsPage() const {
    return output_path.empty() || !page.report_path.empty();
  }

  // Draws the picture. Throws Error: kNotFound where nothing was refined, and
  // what RequireWritableOutput, ReadComparisonRow and WritePng throw.
  void WritePicture(const Workspace& workspace) const;

  // The options of the page. Throws kBadOption.
  PageOptions Page(const Workspace& workspace) const;
};

}  // namespace tsar
