// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_workspace.h"

#include <sstream>

#include "tests/cuda/cuda_test.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

class FusionOnCudaTest : public CudaTest {
 protected:
  std::string Fuse(FusionPreset preset,
                   DeviceChoice device,
                   double cache_size) {
    FuseWorkspaceOptions options;
    options.fusion = PresetFusionOptions(preset);
    options.devices.choice = device;
    options.devices.cache_size = cache_size;
    options.output_path = folder_.Path() / "fused.ply";
    std::ostringstream out;
    Progress progress(out, false);
    const FuseSummary summary = FuseWorkspace(
        Workspace(root_, MapType::kGeometric), options, progress, [] {
          return false;
        });
    EXPECT_GT(summary.num_points, 500);
    return ReadText(options.output_path) +
           ReadText(options.output_path.string() + ".vis");
  }

  const TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(FusionOnCudaTest, CloudsHaveTheSameBytesOnAllDevices) {
  MakeSyntheticWorkspace(root_);
  for (const FusionPreset preset :
       {FusionPreset::kDefault, FusionPreset::kPaper, FusionPreset::kColmap}) {
    const std::string on_cpu = Fuse(preset, DeviceChoice::kCpu, 1.0);
    EXPECT_TRUE(Fuse(preset, DeviceChoice::kCuda, 1.0) == on_cpu);
    EXPECT_TRUE(Fuse(preset, DeviceChoice::kCuda, 1e-4) == on_cpu);
  }
}

}  // namespace
}  // namespace tsar
