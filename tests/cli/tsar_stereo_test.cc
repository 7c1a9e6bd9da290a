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

// The commands share the options of devices and memory; messages use the names
// of this command.
TEST_F(TsarStereoTest, WrongOptionsAreOneLineAndLeaveTheWorkspaceAsItIs) {
  const std::string group = "--TsarStereo.";
  std::vector<std::pair<Words, std::string>> failures = {
      {{group + "depth_min", "3"}, "depth_max"},
      {{group + "device", "cpu", group + "depth_min=1", group + "depth_max=9"},
       "--overwrite 1"}};
  for (const auto& [key, value] : {std::pair("device", "cuda"),
                                   std::pair("gpu_index", "first"),
                                   std::pair("gpu_index", "0,0"),
                                   std::pair("num_threads", "0"),
                                   std::pair("cache_size", "0")}) {
    if (std::string(value) != "cuda" || Device::NumCudaDevices() == 0) {
      failures.push_back(
          {{"--overwrite", "1", group + key, value}, group + key});
    }
  }
  for (const auto& [arguments, text] : failures) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    ExpectFailure(arguments, Words{text});
  }
}

}  // namespace
}  // namespace tsar
