// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// The time of each stage of tsar_refine on one image, with its options' default
// values:
//
//   tsar_stages [--device cpu] [--benchmark_filter=Median] [...]
//
// Draws a room, or takes the first image of --workspace_path. Times are
// wall-clock times, from the call until the device is idle. items_per_second
// and bytes_per_second count what a stage must do at least (the cases in
// stages/ say what that is): a low number means that the stage does more than
// it must. Options that begin with --benchmark_ are Google Benchmark's.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/device/thread_pool.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/scene/room_workspace.h"
#include "benchmarks/stages/cases.h"
#include <benchmark/benchmark.h>
#include <unistd.h>

namespace tsar {
namespace {

struct StagesCommand {
  std::filesystem::path workspace_path;
  std::string device = "auto";
  int gpu_index = 0;
  int num_threads = -1;
  int width = 0;
  int height = 0;
  int num_sources = 10;
};

// A folder for as long as this object lives.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("tsar_stages_" + std::to_string(getpid()))) {}
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

bool ParseOptions(const std::vector<char*>& arguments, StagesCommand* command) {
  OptionSet options("tsar_stages",
                    "Measures every stage of tsar_refine on one image. Options "
                    "that begin with --benchmark_ go to Google Benchmark.",
                    "tsar_stages --device cpu --benchmark_filter=Median");
  options.Add("workspace_path",
              &command->workspace_path,
              "Measure on the first image of this dense workspace. If empty, "
              "on a synthetic room.");
  options
      .Add("device",
           &command->device,
           "Where to compute; auto: on a GPU where there is one.")
      .choices = {"auto", "cuda", "cpu"};
  options.Add(
      "gpu_index", &command->gpu_index, "Number of the GPU.", {0, 1000});
  options.Add("num_threads",
              &command->num_threads,
              "Number of CPU threads; -1: one for each core.",
              {-1, 4096});
  options.Add("width",
              &command->width,
              "Of the drawn maps; 0: 3110 x 2073 on a GPU, 1244 x 829 on the "
              "CPU.",
              {0, 100000});
  options.Add("height",
              &command->height,
              "Of the drawn maps; 0: two thirds of the width.",
              {0, 100000});
  options.Add(
      "num_sources", &command->num_sources, "Source images.", {1, 1000});
  return options.Parse(static_cast<int>(arguments.size()), arguments.data());
}

ViewSet MakeSyntheticViews(const StagesCommand& command, bool is_cuda) {
  const TemporaryFolder folder;
  RoomWorkspaceOptions scene;
  if (command.width > 0) {
    scene.width = command.width;
    scene.height = command.width * 2 / 3;
  } else if (!is_cuda) {
    scene.width = 1244;
    scene.height = 829;
  }
  if (command.height > 0) {
    scene.height = command.height;
  }
  scene.num_sources = command.num_sources;
  scene.num_images = command.num_sources + 1;
  ThreadPool threads(command.num_threads);
  WriteRoomWorkspace(folder.Path(), scene, threads, [] {});
  return LoadFirstView(folder.Path(), command.num_sources);
}

void Measure(const StageCase& stage, Device& device, benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  // Once for the device's memory pool and for code that is loaded when first
  // called.
  stage.prepare();
  stage.run();
  for (auto _ : state) {
    stage.prepare();
    device.Synchronize();
    const Clock::time_point start = Clock::now();
    stage.run();
    device.Synchronize();
    state.SetIterationTime(
        std::chrono::duration<double>(Clock::now() - start).count());
  }
  const auto iterations = static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<int64_t>(iterations * stage.num_items));
  state.SetBytesProcessed(static_cast<int64_t>(iterations * stage.num_bytes));
}

int Main(int argc, char** argv) {
  std::vector<char*> own = {argv[0]};
  std::vector<char*> benchmarks = {argv[0]};
  for (int i = 1; i < argc; ++i) {
    const bool is_benchmarks = std::string(argv[i]).starts_with("--benchmark_");
    (is_benchmarks ? benchmarks : own).push_back(argv[i]);
  }
  StagesCommand command;
  if (!ParseOptions(own, &command)) {
    return 0;
  }
  auto num_benchmarks = static_cast<int>(benchmarks.size());
  benchmark::Initialize(&num_benchmarks, benchmarks.data());
  if (benchmark::ReportUnrecognizedArguments(num_benchmarks,
                                             benchmarks.data())) {
    return 1;
  }
  const bool is_cuda =
      command.device == "cuda" ||
      (command.device == "auto" && Device::NumCudaDevices() > 0);
  const std::unique_ptr<Device> device =
      is_cuda ? Device::CreateCuda(command.gpu_index)
              : Device::CreateCpu(command.num_threads);
  const ViewSet views =
      command.workspace_path.empty()
          ? MakeSyntheticViews(command, is_cuda)
          : LoadFirstView(command.workspace_path, command.num_sources);
  const StageInputs inputs(views, *device);
  benchmark::AddCustomContext("device", device->Name());
  benchmark::AddCustomContext("maps",
                              std::to_string(inputs.views.Width()) + " x " +
                                  std::to_string(inputs.views.Height()) + ", " +
                                  std::to_string(views.sources.size()) +
                                  " sources");
  for (const auto& make_cases : {TransferCases,
                                 MatchingCases,
                                 RefinementCases,
                                 SegmentationCases,
                                 CompositionCases}) {
    for (const StageCase& stage : make_cases(inputs)) {
      benchmark::RegisterBenchmark(stage.name.c_str(),
                                   [stage, &device](benchmark::State& state) {
                                     Measure(stage, *device, state);
                                   })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  // The cases hold maps in the device's memory.
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::Main, argc, argv);
}
