// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"

#include "tests/cli/captured_run.h"
#include "tests/pipeline/drawn_workspace.h"
#include "tests/workspace/test_workspace.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

Outcome RunStereo(const std::vector<std::string>& arguments) {
  return RunCaptured("colmap", arguments, [](int argc, char** argv) {
    return RunCommand(&RunTsarStereo, argc, argv);
  });
}

TEST(TsarStereo, HelpTeaches) {
  const Outcome outcome = RunStereo({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* text : {"after image_undistorter",
                           "colmap tsar_stereo --workspace_path dense",
                           "--TsarStereo.window_radius INT (default: 5)",
                           "--TsarStereo.geom_consistency 0|1 (default: 1)",
                           "--overwrite"}) {
    EXPECT_THAT(outcome.out, testing::HasSubstr(text));
  }
}

TEST(TsarStereo, FailsWithOneLineAndLeavesTheWorkspaceAsItIs) {
  const TemporaryFolder folder;
  const std::filesystem::path root = folder.Path() / "dense";
  DrawWorkspace(root);
  const auto before = ReadTree(root / "stereo/depth_maps");
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"--TsarStereo.num_iteration", "3"}, "--TsarStereo.num_iterations"},
      {{"--TsarStereo.window_radius", "0"}, "TsarStereo.window_radius"},
      {{"--TsarStereo.depth_min", "3"}, "depth_max"},
      {{"--TsarStereo.device",
        "cpu",
        "--TsarStereo.depth_min",
        "1",
        "--TsarStereo.depth_max",
        "9"},
       "--overwrite 1"},
  };
  for (const auto& [given, text] : cases) {
    std::vector<std::string> arguments = given;
    arguments.insert(arguments.end(), {"--workspace_path", root.string()});
    const Outcome outcome = RunStereo(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err.rfind("ERROR: ", 0), 0u) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(text));
  }
  EXPECT_TRUE(ReadTree(root / "stereo/depth_maps") == before);
}

}  // namespace
}  // namespace tsar
