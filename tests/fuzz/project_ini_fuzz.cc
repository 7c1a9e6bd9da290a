// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

void Read(std::span<const uint8_t> input) {
  std::filesystem::path workspace_path = "dense";
  std::string device = "auto";
  int num_threads = -1;
  int seed = 0;
  double sigma = 2.0;
  float cache_size = 32.f;
  bool filter = true;
  OptionSet options("tsar_refine", "Refines.", "tsar_refine");
  options.AddRequired("workspace_path", &workspace_path, "A folder.");
  options.AddChoice("TsarRefine.device", &device, {"auto", "cpu"}, "Where.");
  options.Add("TsarRefine.num_threads", &num_threads, "Some.", {-1, 4096});
  options.Add("TsarRefine.seed", &seed, "A number.");
  options.Add("TsarRefine.spatial_sigma", &sigma, "Pixels.", {0.1, 100});
  options.Add("TsarRefine.cache_size", &cache_size, "Gigabytes.");
  options.Add("TsarRefine.filter", &filter, "Whether to.");
  const std::string path = PutFile("project.ini", input).string();
  const char* arguments[] = {
      "colmap_tsar", "--workspace_path", "dense", "--project_path", ""};
  arguments[4] = path.c_str();
  Accepts([&] { options.Parse(5, arguments); });
}

std::vector<std::string> MakeSeeds() {
  return {
      "log_to_stderr=true\nworkspace_path=dense\n[TsarRefine]\n"
      "device = cpu\nnum_threads=2\nseed=12345678901\nspatial_sigma=2.5\n"
      "cache_size=1e1\nfilter=false\n[PatchMatchStereo]\nwindow_step=1\n",
      "# nothing\n[TsarRefine]\nfilter=1 # yes\n"};
}

}  // namespace

const FuzzTarget kProjectIniTarget = {"project_ini", &Read, &MakeSeeds};

}  // namespace tsar
