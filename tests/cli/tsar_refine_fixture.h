// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/commands.h"

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/captured_run.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <nlohmann/json.hpp>

namespace tsar {

inline Outcome RunRefine(const std::vector<std::string>& arguments) {
  return RunCaptured("colmap", arguments, [](int argc, char** argv) {
    return RunCommand(&RunTsarRefine, argc, argv);
  });
}

class TsarRefineTest : public testing::Test {
 protected:
  void SetUp() override { MakeSyntheticWorkspace(root_); }

  Outcome Run(std::vector<std::string> arguments) const {
    for (const std::string& argument : {std::string("--workspace_path"),
                                        root_.string(),
                                        std::string("--TsarRefine.device"),
                                        std::string("cpu")}) {
      arguments.push_back(argument);
    }
    return RunRefine(arguments);
  }

  // Expects exit code 1, one line with these texts, and no file changed.
  void ExpectFailure(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& texts) const {
    const auto before = ReadTree(folder_.Path());
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err.find("ERROR: "), 0u) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_THAT(outcome.err, testing::HasSubstr(text));
    }
    EXPECT_TRUE(ReadTree(folder_.Path()) == before);
  }

  nlohmann::json UsedOptions() const {
    return nlohmann::json::parse(
        ReadText(root_ / "stereo/tsar/manifest.json"))["options"];
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

}  // namespace tsar
