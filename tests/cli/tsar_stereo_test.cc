// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/device.h"

#include "tests/cli/command_test.h"
#include "tests/support/external_writers.h"

namespace tsar {
namespace {

class TsarStereoTest : public CommandTest<&RunTsarStereo> {
 protected:
  void SetUp() override { MakeSyntheticWorkspace(root_); }
};

TEST_F(TsarStereoTest, FailsWithOneLineAndLeavesTheWorkspaceAsItIs) {
  ExpectFailure({"--TsarStereo.num_iteration", "3"},
                "--TsarStereo.num_iterations");
  ExpectFailure({"--TsarStereo.window_radius", "0"},
                "TsarStereo.window_radius");
  ExpectFailure({"--TsarStereo.depth_min", "3"}, "depth_max");
  ExpectFailure({"--TsarStereo.device",
                 "cpu",
                 "--TsarStereo.depth_min",
                 "1",
                 "--TsarStereo.depth_max",
                 "9"},
                "--overwrite 1");
}

TEST_F(TsarStereoTest, TellsWhichDepthPriorsWereNotUsed) {
  const std::filesystem::path priors = folder_.Path() / "priors";
  std::filesystem::create_directories(priors);
  WriteText(priors / "v0.pfm",
            PfmBytes(8, 6, 1, std::vector<float>(48, 2.f), true));
  const Words words = {"--prior_path",
                       priors.string(),
                       "--TsarStereo.depth_min",
                       "2.5",
                       "--TsarStereo.depth_max",
                       "10",
                       "--TsarStereo.max_image_size",
                       "24",
                       "--TsarStereo.device",
                       "cpu",
                       "--overwrite",
                       "1"};
  const Outcome outcome = Run(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr(
                  "  depth priors for 1 of 4 images, 1 of them not used\n"
                  "  v0.png: depth prior not used: "));
  ExpectFailure({"--prior_path",
                 priors.string(),
                 "--TsarStereo.planar_prior",
                 "0",
                 "--TsarStereo.device",
                 "cpu"},
                "turn --TsarStereo.planar_prior and "
                "--TsarStereo.geom_consistency on");
}

// The two commands share what works with devices and memory.
TEST_F(TsarStereoTest, DeviceOptionsAreCalledByItsOwnNames) {
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
    const Outcome outcome = Run({"--overwrite", "1", option, value});
    EXPECT_EQ(outcome.exit_code, 1) << option << " " << value;
    EXPECT_THAT(outcome.err, testing::HasSubstr(option));
    EXPECT_EQ(outcome.err.find("TsarRefine"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace tsar
