// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/device/device.h"

#include "tests/cli/captured_run.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
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
  MakeSyntheticWorkspace(root);
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

// The two commands share what works with devices and memory.
TEST(TsarStereo, DeviceOptionsAreCalledByItsOwnNames) {
  const TemporaryFolder folder;
  const std::filesystem::path root = folder.Path() / "dense";
  MakeSyntheticWorkspace(root);
  const std::pair<const char*, const char*> wrong[] = {
      {"device", "gpu"},
      {"device", "cuda"},
      {"gpu_index", "first"},
      {"gpu_index", "0,0"},
      {"num_threads", "0"},
      {"num_threads", "many"},
      {"cache_size", "0"},
      {"cache_size", "0.001"},
  };
  for (const auto& [key, value] : wrong) {
    if (std::string(value) == "cuda" && Device::NumCudaDevices() > 0) {
      continue;
    }
    const std::string option = std::string("--TsarStereo.") + key;
    const Outcome outcome = RunStereo(
        {"--workspace_path", root.string(), "--overwrite", "1", option, value});
    EXPECT_EQ(outcome.exit_code, 1) << option << " " << value;
    EXPECT_THAT(outcome.err, testing::HasSubstr(option));
    EXPECT_EQ(outcome.err.find("TsarRefine"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace tsar
