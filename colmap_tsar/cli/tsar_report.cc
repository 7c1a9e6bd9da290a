// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/report/comparison_picture.h"
#include "colmap_tsar/report/png.h"
#include "colmap_tsar/report/workspace_comparison.h"
#include "colmap_tsar/workspace/workspace.h"

#include <iostream>
#include <string>
#include <vector>

namespace tsar {

int RunTsarReport(int argc, char** argv) {
  std::string workspace_path;
  std::string output_path;
  std::string input_type = ToString(MapType::kGeometric);
  int num_images = 3;

  OptionSet options(
      "tsar_report",
      "Draws a picture (PNG) that shows, for some images of a refined "
      "workspace, depth and normals before and after and where each depth "
      "comes from.",
      "tsar_report --workspace_path dense --output_path comparison.png");
  options.AddRequired(
      "workspace_path", &workspace_path, "The refined dense workspace.");
  options.AddRequired("output_path", &output_path, "The picture to write.");
  options.AddChoice(
      "input_type",
      &input_type,
      {ToString(MapType::kGeometric), ToString(MapType::kPhotometric)},
      "The maps that were refined.");
  options.Add("num_images",
              &num_images,
              "How many images to show, spread evenly over the refined ones.",
              {1, 100});
  if (!options.Parse(argc, argv)) {
    return 0;
  }

  const Workspace workspace(workspace_path,
                            input_type == ToString(MapType::kGeometric)
                                ? MapType::kGeometric
                                : MapType::kPhotometric);
  const std::vector<int> refined = FindRefinedImages(workspace);
  if (refined.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      workspace_path,
                      "has no refined " + input_type + " maps",
                      "run tsar_refine on it first");
  }
  std::vector<ComparisonRow> rows;
  for (const int image : PickEvenly(refined, num_images)) {
    rows.push_back(ReadComparisonRow(workspace, image));
  }
  WritePng(output_path, DrawComparison(rows));
  std::cout << "Wrote " << output_path << std::endl;
  return 0;
}

}  // namespace tsar
