// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Several devices of one machine together, and whole runs on each.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/cuda_device.h"
#include "colmap_tsar/fusion/fuse_workspace.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/pipeline_devices.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cstring>
#include <map>
#include <sstream>
#include <thread>

#include "tests/support/column_workspace.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr auto kChunk = static_cast<int64_t>(CudaStaging::kChunkSize);

std::vector<uint8_t> DrawnBytes(size_t size, uint32_t seed) {
  std::vector<uint8_t> bytes(size);
  Philox random(seed, 0, 0);
  for (uint8_t& byte : bytes) {
    byte = static_cast<uint8_t>(random.NextBelow(256));
  }
  return bytes;
}

TEST(WorkersOnCudaTest, CopiesOfAnySizeAreComplete) {
  const auto device = Device::CreateCuda(0);
  for (const int64_t size : {int64_t{1},
                             kChunk - 1,
                             kChunk,
                             kChunk + 1,
                             2 * kChunk,
                             3 * kChunk + 5}) {
    std::vector<uint8_t> host = DrawnBytes(static_cast<size_t>(size), 1);
    const std::vector<uint8_t> expected = host;
    const Buffer<uint8_t> buffer(*device, host);
    // The upload has returned, so the source may change.
    std::fill(host.begin(), host.end(), uint8_t{0});
    EXPECT_TRUE(buffer.ToHost() == expected) << size;
  }
  EXPECT_TRUE(
      Buffer<uint8_t>(*device, std::vector<uint8_t>()).ToHost().empty());
}

TEST(WorkersOnCudaTest, TwoDevicesOfOneGpuCopySideBySide) {
  std::vector<std::jthread> threads;
  for (uint32_t seed = 0; seed < 2; ++seed) {
    threads.emplace_back([seed] {
      const auto device = Device::CreateCuda(0);
      const std::vector<uint8_t> expected =
          DrawnBytes(static_cast<size_t>(kChunk) * 2 + seed, seed);
      for (int i = 0; i < 20; ++i) {
        const Buffer<uint8_t> buffer(*device, expected);
        EXPECT_TRUE(buffer.ToHost() == expected);
      }
    });
  }
}

TEST(WorkersOnCudaTest, CountsMemory) {
  constexpr size_t kSize = size_t{256} << 20;
  const auto device = Device::CreateCuda(0);
  const size_t before = device->FreeMemory();
  ASSERT_GT(before, kSize);
  {
    const Buffer<uint8_t> buffer(*device, kSize);
    device->Synchronize();
    EXPECT_LT(device->FreeMemory(), before);
    EXPECT_GE(device->PeakMemory(), kSize);
  }
  EXPECT_GE(device->PeakMemory(), kSize);
}

TEST(WorkersOnCudaTest, WorksAfterAnAllocationThatFailed) {
  const auto device = Device::CreateCuda(0);
  ExpectError(ErrorCode::kOutOfMemory, {"GPU memory", "device cpu"}, [&] {
    Buffer<uint8_t>(*device, size_t{1} << 50);
  });
  const Image<Rgb> color(37, 3, {10, 20, 30});
  EXPECT_EQ(ComputeGray(DeviceImage<Rgb>(*device, color).View(), *device)
                .ToHost()(36, 2),
            0.299f * 10 + 0.587f * 20 + 0.114f * 30);
}

bool HaveSameBytes(const RefinedMaps& a, const RefinedMaps& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.HasSizeOf(y) &&
           std::memcmp(x.Data(), y.Data(), x.NumPixels() * sizeof(*x.Data())) ==
               0;
  };
  return same(a.depth, b.depth) && same(a.normal, b.normal) &&
         same(a.confidence, b.confidence) && same(a.sigma, b.sigma) &&
         same(a.provenance, b.provenance);
}

TEST(WorkersOnCudaTest, WorkersShareViewsAndGiveTheSameBytes) {
  const SyntheticViews drawn = MakeSyntheticViews({});
  const int num_views = static_cast<int>(drawn.views.size());
  const auto refine = [&](int reference, const PipelineWorker& worker) {
    std::vector<UploadedViews::Pointer> sources;
    for (int i = 0; i < num_views; ++i) {
      if (i != reference) {
        sources.push_back(worker.Upload(i, drawn.views[i]));
      }
    }
    return RefineImage(drawn.views[reference],
                       sources,
                       static_cast<uint32_t>(reference),
                       {},
                       *worker.device)
        .maps;
  };
  std::vector<RefinedMaps> expected;
  {
    PipelineWorker gpu = {"", Device::CreateCuda(0)};
    UploadedViews cache(100);
    gpu.views = &cache;
    for (int i = 0; i < num_views; ++i) {
      expected.push_back(refine(i, gpu));
    }
  }
  // With room for all views, and only for those in use.
  for (const size_t max_num_views : {100, 0}) {
    PipelineWorker gpus[] = {{"", Device::CreateCuda(0)},
                             {"", Device::CreateCuda(0)}};
    UploadedViews cache(max_num_views);
    gpus[0].views = gpus[1].views = &cache;
    std::vector<std::jthread> threads;
    for (int worker = 0; worker < 2; ++worker) {
      threads.emplace_back([&, worker] {
        for (int i = 0; i < 4 * num_views; ++i) {
          const int reference = (i + 2 * worker) % num_views;
          EXPECT_TRUE(HaveSameBytes(refine(reference, gpus[worker]),
                                    expected[reference]));
        }
      });
    }
    threads.clear();
  }
}

class WorkspaceOnCudaTest : public testing::Test {
 protected:
  using Tree = std::map<std::string, std::string>;

  static DeviceOptions Gpus(const std::string& gpu_index) {
    DeviceOptions devices;
    devices.choice = DeviceChoice::kCuda;
    devices.gpu_indices = ParseGpuIndices(gpu_index);
    return devices;
  }
  static DeviceOptions Cpu() {
    DeviceOptions devices;
    devices.choice = DeviceChoice::kCpu;
    devices.num_threads = 2;
    return devices;
  }

  RunSummary Refine(const std::string& gpu_index,
                    const std::string& output,
                    const RefineOptions& refine = {}) {
    return Refine(Gpus(gpu_index), output, refine);
  }
  RunSummary Refine(const DeviceOptions& devices,
                    const std::string& output,
                    const RefineOptions& refine) {
    WorkspaceRefineOptions options;
    options.workspace_path = root_;
    options.output_path = folder_.Path() / output;
    options.devices = devices;
    std::ostringstream text;
    Progress progress(text, false);
    return RefineWorkspace(options, refine, progress);
  }
  Tree Maps(const std::string& output) {
    Tree maps;
    for (const char* name : {"depth_maps",
                             "normal_maps",
                             "confidence_maps",
                             "sigma_maps",
                             "provenance_maps",
                             "cost_maps"}) {
      const std::filesystem::path path =
          folder_.Path() / output / "stereo" / name;
      if (!std::filesystem::exists(path)) {
        continue;
      }
      for (auto& [file, content] : ReadTree(path)) {
        maps[std::string(name) + "/" + file] = std::move(content);
      }
    }
    return maps;
  }
  static void ExpectSameFiles(const Tree& expected, const Tree& actual) {
    EXPECT_EQ(actual.size(), expected.size());
    for (const auto& [file, content] : expected) {
      const auto found = actual.find(file);
      EXPECT_TRUE(found != actual.end() && found->second == content) << file;
    }
  }
  void WriteConfig(const std::vector<std::string>& names) {
    std::string config;
    for (const std::string& name : names) {
      config += name + "\n__all__\n";
    }
    WriteText(root_ / "stereo/patch-match.cfg", config);
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(WorkspaceOnCudaTest, OneWorkerAndSeveralGiveTheSameBytes) {
  MakeSyntheticWorkspace(root_);
  // Otherwise the evidence of images that are not refined would be missing.
  RefineOptions options;
  options.scene_planes = false;
  const RunSummary several = Refine("0", "several", options);
  EXPECT_EQ(several.num_workers, 4);
  EXPECT_EQ(several.num_refined, 4);
  ASSERT_EQ(several.peak_gpu_memory.size(), 1u);
  EXPECT_GT(several.peak_gpu_memory[0].num_bytes, 0u);
  const Tree expected = Maps("several");
  for (const std::string& name : SyntheticWorkspace::Names()) {
    WriteConfig({name});
    std::filesystem::remove_all(folder_.Path() / "one");
    EXPECT_EQ(Refine("0", "one", options).num_workers, 1);
    for (const auto& [file, content] : Maps("one")) {
      if (file.find(name + ".geometric") != std::string::npos) {
        EXPECT_TRUE(content == expected.at(file)) << file;
      }
    }
  }
}

TEST_F(WorkspaceOnCudaTest, AllGpusGiveTheSameBytes) {
  MakeSyntheticWorkspace(root_);
  Refine("0", "first");
  EXPECT_EQ(Refine("-1", "all").num_refined, 4);
  EXPECT_TRUE(Maps("first") == Maps("all"));
  if (Device::NumCudaDevices() < 2) {
    GTEST_SKIP() << "one CUDA device only: the rest is skipped";
  }
  Refine("1", "second");
  EXPECT_TRUE(Maps("first") == Maps("second"));
  EXPECT_EQ(Refine("1,0", "both").num_workers, 4);
  EXPECT_TRUE(Maps("first") == Maps("both"));
}

TEST_F(WorkspaceOnCudaTest, CpuAndGpuRefineToTheSameBytes) {
  MakeSyntheticWorkspace(root_);
  const std::pair<const char*, RefineOptions> presets[] = {
      {"default", RefineOptions()},
      {"paper", PresetOptions(RefinePreset::kPaper)}};
  for (const auto& [name, options] : presets) {
    const std::string preset = name;
    EXPECT_EQ(Refine(Cpu(), preset + " on the CPU", options).num_refined, 4);
    EXPECT_EQ(Refine("0", preset + " on a GPU", options).num_refined, 4);
    const Tree expected = Maps(preset + " on the CPU");
    EXPECT_GE(expected.size(), 16u) << preset;
    ExpectSameFiles(expected, Maps(preset + " on a GPU"));
  }
}

// Columns are found on the host, and filled on the device.
TEST_F(WorkspaceOnCudaTest, CpuAndGpuFillAColumnWithTheSameBytes) {
  MakeColumnWorkspace(root_);
  EXPECT_EQ(Refine(Cpu(), "on the CPU", {}).num_refined,
            ColumnWorkspace::kNumViews);
  EXPECT_EQ(Refine("0", "on a GPU").num_refined, ColumnWorkspace::kNumViews);
  for (const char* run : {"on the CPU", "on a GPU"}) {
    EXPECT_EQ(ReadSceneModel(folder_.Path() / run / "stereo/tsar/planes.bin")
                  .cylinders.size(),
              1u)
        << run;
  }
  ExpectSameFiles(Maps("on the CPU"), Maps("on a GPU"));
}

TEST_F(WorkspaceOnCudaTest, CpuAndGpuMatchToTheSameBytes) {
  StereoOptions options;
  options.depth_min = 0.5 * SyntheticWorkspace::kDepth;
  options.depth_max = 2.0 * SyntheticWorkspace::kDepth;
  options.max_image_size = SyntheticWorkspace::kWidth / 2;
  const auto match = [&](const DeviceOptions& devices) {
    std::filesystem::remove_all(root_);
    MakeSyntheticWorkspace(root_);
    for (const char* name : {"depth_maps", "normal_maps"}) {
      std::filesystem::remove_all(root_ / "stereo" / name);
    }
    std::ostringstream text;
    Progress progress(text, false);
    const StereoSummary summary =
        MatchWorkspace(root_, devices, options, /*overwrite=*/false, progress);
    EXPECT_EQ(summary.num_images, 4);
    return Maps("dense");
  };
  const Tree expected = match(Cpu());
  EXPECT_GE(expected.size(), 16u);
  ExpectSameFiles(expected, match(Gpus("0")));
}

TEST_F(WorkspaceOnCudaTest, CpuAndGpuFuseToTheSameBytes) {
  MakeSyntheticWorkspace(root_);
  const auto fuse =
      [&](const std::string& preset, DeviceChoice device, double cache_size) {
        FuseWorkspaceOptions options;
        options.fusion = PresetFusionOptions(preset);
        options.devices.choice = device;
        options.devices.cache_size = cache_size;
        options.output_path = folder_.Path() / "fused.ply";
        std::ostringstream out;
        Progress progress(out, false);
        const FuseSummary summary = FuseWorkspace(
            Workspace(root_, MapType::kGeometric), options, progress);
        EXPECT_GT(summary.num_points, 500);
        return ReadText(options.output_path) +
               ReadText(options.output_path.string() + ".vis");
      };
  for (const std::string& preset : FusionPresetNames()) {
    const std::string on_cpu = fuse(preset, DeviceChoice::kCpu, 1.0);
    EXPECT_TRUE(fuse(preset, DeviceChoice::kCuda, 1.0) == on_cpu);
    EXPECT_TRUE(fuse(preset, DeviceChoice::kCuda, 1e-4) == on_cpu);
  }
}

TEST_F(WorkspaceOnCudaTest, RefusesGpusAndImagesThatCannotBe) {
  MakeSyntheticWorkspace(root_);
  const std::string beyond = std::to_string(Device::NumCudaDevices());
  ExpectError(ErrorCode::kDevice, {"gpu_index", "no GPU " + beyond}, [&] {
    Refine(beyond, "out");
  });
  EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "out"));
  WorkspaceOverview overview;
  overview.max_num_pixels = int64_t{1} << 34;
  overview.max_num_sources = 10;
  DeviceOptions options;
  options.choice = DeviceChoice::kCuda;
  options.gpu_indices = {0};
  ExpectError(
      ErrorCode::kDevice,
      {"GPU 0 (", "GB of GPU memory", "are free", "max_image_size"},
      [&] { OpenPipelineDevices(options, PlanRefinement({}, overview), 10); });
}

}  // namespace
}  // namespace tsar
