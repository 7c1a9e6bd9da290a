// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_devices.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/controllers/memory_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

namespace tsar {
namespace {

constexpr double kBytesPerGigabyte = 1e9;
// Of the machine's memory; the rest is for the system, its cache of files that
// are read and written, and what the plan does not count.
constexpr double kUsableShare = 0.8;

// Reading and writing an image each take up to ten times as long as one GPU
// needs for it with its two workers.
constexpr int kFilesThreadsPerGpu = 10;
// A CPU computes on an image for so long that one thread keeps many supplied.
constexpr int kCpuWorkersPerFilesThread = 8;

struct Gpu {
  std::string name;
  int index = 0;
  int max_num_workers = 0;  // As many as its memory allows.
  std::vector<std::unique_ptr<Device>> devices;  // One for each worker.
};

std::string NoGpu(int index, int num_gpus) {
  return OptionName("gpu_index") + ": there is no GPU " +
         std::to_string(index) + "; this machine has " +
         std::to_string(num_gpus) +
         (num_gpus == 1 ? ", number 0"
                        : ", numbers 0 to " + std::to_string(num_gpus - 1));
}

// The GPUs to try, in their order.
std::vector<int> WantedGpus(const std::vector<int>& named, int num_gpus) {
  std::vector<int> indices = named;
  if (named.empty()) {
    indices.resize(static_cast<size_t>(num_gpus));
    std::iota(indices.begin(), indices.end(), 0);
  }
  for (const int index : indices) {
    if (index >= num_gpus) {
      throw Error(ErrorCode::kDevice, NoGpu(index, num_gpus));
    }
  }
  return indices;
}

// Calls a function and returns its Error, or nothing.
template <typename Function>
std::optional<Error> Attempt(Function function) {
  try {
    function();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

// Opens GPUs, each with one device, until there is one for each image.
class GpuOpener {
 public:
  GpuOpener(const WorkspaceOverview& overview,
            const GpuSystem& gpus,
            bool are_named)
      : overview_(overview), gpus_(gpus), are_named_(are_named) {}

  void Open(int index) {
    Gpu gpu;
    gpu.index = index;
    const auto open = [&] {
      gpu.devices.push_back(gpus_.create(index));
      gpu.name =
          "GPU " + std::to_string(index) + " (" + gpu.devices[0]->Name() + ")";
    };
    const auto plan = [&] {
      const size_t free_bytes = std::min(gpu.devices[0]->FreeMemory(),
                                         static_cast<size_t>(INT64_MAX));
      gpu.max_num_workers =
          NumGpuWorkers(overview_, static_cast<int64_t>(free_bytes), gpu.name);
    };
    if (Keep(Attempt(open), &not_opened_) && Keep(Attempt(plan), &too_small_)) {
      opened_.push_back(std::move(gpu));
    }
  }

  size_t NumOpened() const { return opened_.size(); }

  // None where the CPU is to be used instead. Throws where one is needed. That
  // no GPU has enough memory is an error also with device "auto": the CPU would
  // take a hundred times as long.
  std::vector<Gpu> Take(bool is_auto) {
    if (opened_.empty() && too_small_) {
      throw Error(*too_small_);
    }
    if (opened_.empty() && not_opened_ && !is_auto) {
      throw Error(*not_opened_);
    }
    for (const std::string& warning : warnings_) {
      Warn(warning);
    }
    return std::move(opened_);
  }

 private:
  // Whether there was no failure; the first of its kind is remembered. One of a
  // GPU that the user named is thrown.
  bool Keep(const std::optional<Error>& failure, std::optional<Error>* first) {
    if (!failure) {
      return true;
    }
    if (are_named_) {
      throw Error(*failure);
    }
    if (!*first) {
      first->emplace(*failure);
    }
    warnings_.push_back(failure->what());
    return false;
  }

  const WorkspaceOverview& overview_;
  const GpuSystem& gpus_;
  const bool are_named_;
  std::vector<Gpu> opened_;
  std::optional<Error> not_opened_;
  std::optional<Error> too_small_;
  std::vector<std::string> warnings_;
};

// The GPUs to use, each with one device; none where the CPU is to be used.
std::vector<Gpu> OpenGpus(const DeviceOptions& options,
                          const WorkspaceOverview& overview,
                          int num_images,
                          const GpuSystem& gpus) {
  const std::vector<int>& named = options.gpu_indices;
  const bool is_auto = options.choice == DeviceChoice::kAuto;
  if (options.choice == DeviceChoice::kCpu) {
    return {};
  }
  const int num_gpus = gpus.count();
  if (num_gpus == 0 && !is_auto) {
    // Says why there is none.
    gpus.create(named.empty() ? 0 : named[0]);
  }
  std::vector<Gpu> opened;
  if (num_gpus > 0) {
    GpuOpener opener(overview, gpus, !named.empty());
    const std::vector<int> wanted = WantedGpus(named, num_gpus);
    if (static_cast<int>(wanted.size()) <= num_images) {
      gpus.prepare(wanted);
    }
    for (const int index : wanted) {
      if (static_cast<int>(opener.NumOpened()) < num_images) {
        opener.Open(index);
      }
    }
    opened = opener.Take(is_auto);
  }
  if (opened.empty()) {
    Warn("there is no GPU that can be used; going on with the CPU");
  }
  return opened;
}

// Gives GPUs further devices, one after the other, as long as images are left.
void AddDevices(int num_images,
                const GpuSystem& gpus,
                std::vector<Gpu>* opened) {
  int num_left = num_images - static_cast<int>(opened->size());
  for (int round = 1; round < kMaxGpuWorkers; ++round) {
    for (Gpu& gpu : *opened) {
      if (num_left <= 0 || gpu.max_num_workers <= round) {
        continue;
      }
      const auto failure =
          Attempt([&] { gpu.devices.push_back(gpus.create(gpu.index)); });
      if (failure) {
        Warn(failure->what() + ("; " + gpu.name) + " works on " +
             std::to_string(gpu.devices.size()) + " image at a time");
        gpu.max_num_workers = round;
      } else {
        --num_left;
      }
    }
  }
}

std::string Describe(const std::vector<Gpu>& gpus) {
  std::string text;
  for (const Gpu& gpu : gpus) {
    text += (text.empty() ? "" : ", ") + gpu.name;
  }
  return text;
}

void AddGpuWorkers(std::vector<Gpu> opened,
                   const WorkspaceOverview& overview,
                   RefineDevices* result) {
  result->description = Describe(opened);
  for (Gpu& gpu : opened) {
    const int num_workers = static_cast<int>(gpu.devices.size());
    result->view_caches.push_back(std::make_unique<DeviceViewCache>(
        static_cast<size_t>(SharedViewBytes(overview, num_workers))));
    for (std::unique_ptr<Device>& device : gpu.devices) {
      result->workers.push_back(
          {gpu.name, std::move(device), result->view_caches.back().get()});
    }
  }
}

void AddCpuWorkers(int num_workers,
                   const WorkspaceOverview& overview,
                   int num_threads,
                   RefineDevices* result) {
  result->description = std::to_string(num_threads) + " CPU thread" +
                        (num_threads == 1 ? "" : "s");
  result->view_caches.push_back(std::make_unique<DeviceViewCache>(
      static_cast<size_t>(SharedViewBytes(overview, num_workers))));
  for (int i = 0; i < num_workers; ++i) {
    const int remainder = i < num_threads % num_workers ? 1 : 0;
    result->workers.push_back(
        {"the CPU",
         Device::CreateCpu(num_threads / num_workers + remainder),
         result->view_caches.back().get()});
  }
}

// Main memory for all the views of one image.
int64_t BytesForViews(const WorkspaceOverview& overview) {
  return (overview.max_num_sources + 1) * ViewBytes(overview);
}

PipelineSizes GpuSizes(int num_files_threads, size_t num_workers) {
  return {num_files_threads,
          num_files_threads,
          num_workers,
          static_cast<size_t>(num_files_threads)};
}

PipelineSizes CpuSizes(int num_files_threads, size_t /*num_workers*/) {
  return {num_files_threads, num_files_threads, 1, 1};
}

// Main memory that is not for views: what the workers need, results, each of
// which is with a worker, waits, or is being written, and what is only there
// while a view is read.
int64_t BytesBesideViews(const WorkspaceOverview& overview,
                         int num_images,
                         int64_t work_bytes,
                         size_t num_workers,
                         bool finds_scenes_ahead,
                         const PipelineSizes& sizes) {
  // Images whose neighbours' evidence is in use, and those in which planes are
  // being found, by the threads that read or write or by the workers.
  const size_t num_scenes =
      num_workers +
      (finds_scenes_ahead
           ? static_cast<size_t>(sizes.num_loaders) + sizes.max_ready
           : 0);
  const auto num_discoveries = static_cast<int64_t>(
      finds_scenes_ahead ? static_cast<size_t>(sizes.num_loaders)
                         : num_workers);
  const auto num_results =
      std::min<int64_t>(num_images,
                        static_cast<int64_t>(num_workers + sizes.max_finished) +
                            sizes.num_writers);
  return work_bytes + EvidenceBytes(overview, num_scenes) +
         num_discoveries * DiscoveryBytes(overview) +
         num_results * ResultBytes(overview) +
         sizes.num_loaders * LoadBytes(overview);
}

// As many as have memory beside one thread that reads and one that writes.
int NumCpuWorkers(const WorkspaceOverview& overview,
                  int num_images,
                  int64_t budget,
                  int max_num_workers) {
  const int64_t for_files =
      BytesBesideViews(overview, num_images, 0, 0, false, CpuSizes(1, 0));
  const int64_t for_one = WorkBytes(overview) + ResultBytes(overview) +
                          BytesForViews(overview) + DiscoveryBytes(overview) +
                          EvidenceBytes(overview, 1) -
                          EvidenceBytes(overview, 0);
  return static_cast<int>(
      std::clamp<int64_t>((budget - for_files) / std::max<int64_t>(1, for_one),
                          1,
                          max_num_workers));
}

// What the machine's main memory and the user allow.
struct MemoryBudget {
  int64_t num_bytes = 0;
  int64_t machine_bytes = 0;

  MemoryBudget(double cache_size, int64_t machine)
      : num_bytes(static_cast<int64_t>(
            std::min(cache_size * kBytesPerGigabyte,
                     kUsableShare * static_cast<double>(machine)))),
        machine_bytes(machine) {}

  bool IsBoundByMachine(double cache_size) const {
    return kUsableShare * static_cast<double>(machine_bytes) <
           cache_size * kBytesPerGigabyte;
  }
};

double Gigabytes(int64_t num_bytes) {
  return static_cast<double>(num_bytes) / kBytesPerGigabyte;
}

// To a tenth, and not less.
std::string GigabytesText(int64_t num_bytes) {
  TextStream text;
  text << std::ceil(Gigabytes(num_bytes) * 10) / 10 << " GB";
  return text.str();
}

std::string WhatNeeds(const WorkspaceOverview& overview, int64_t needed) {
  return "an image of this workspace with its " +
         std::to_string(overview.max_num_sources) +
         " source images, beside the results of the images at work, needs " +
         GigabytesText(needed) + " of main memory at a time";
}

// Divides main memory between the threads for files and the views.
class MemoryDivision {
 public:
  // num_cpu_workers: 0 where GPUs compute.
  MemoryDivision(const WorkspaceOverview& overview,
                 int num_images,
                 int num_cpu_workers,
                 PipelineSizes (*make_sizes)(int, size_t))
      : overview_(overview),
        num_images_(num_images),
        num_cpu_workers_(num_cpu_workers),
        make_sizes_(make_sizes) {}

  // Sets the number of threads for files, fewer where the views of one image
  // would not fit beside what they hold, and what is left for views. Throws
  // kOutOfMemory where the machine cannot hold even these.
  void Divide(const MemoryBudget& budget,
              double cache_size,
              int max_num_files_threads,
              RefineDevices* result) const {
    const size_t num_workers = result->workers.size();
    int64_t rest = 0;
    for (int num_threads = max_num_files_threads; num_threads > 0;
         --num_threads) {
      result->sizes = make_sizes_(num_threads, num_workers);
      rest =
          budget.num_bytes - BytesBeside(overview_, num_workers, result->sizes);
      if (rest >= BytesForViews(overview_)) {
        break;
      }
    }
    result->cache_num_bytes = static_cast<size_t>(std::max<int64_t>(rest, 0));
    const int64_t needed = budget.num_bytes + BytesForViews(overview_) - rest;
    if (needed > budget.machine_bytes) {
      throw Error(ErrorCode::kOutOfMemory,
                  WhatNeeds(overview_, needed) + ", and this machine gives " +
                      GigabytesText(budget.machine_bytes) +
                      "; run patch_match_stereo with fewer source images or a "
                      "smaller --PatchMatchStereo.max_image_size" +
                      WhatFits(budget.machine_bytes, needed, num_workers));
    }
    if (needed > budget.num_bytes) {
      Warn(WhatNeeds(overview_, needed) + ", more than " +
           LimitText(budget, cache_size) +
           "; the run takes that much. If it is not there, run "
           "patch_match_stereo with fewer source images or a smaller "
           "--PatchMatchStereo.max_image_size");
    }
  }

 private:
  int64_t BytesBeside(const WorkspaceOverview& overview,
                      size_t num_workers,
                      const PipelineSizes& sizes) const {
    return BytesBesideViews(overview,
                            num_images_,
                            num_cpu_workers_ * WorkBytes(overview),
                            num_workers,
                            num_cpu_workers_ == 0,
                            sizes);
  }

  static std::string LimitText(const MemoryBudget& budget, double cache_size) {
    TextStream text;
    if (budget.IsBoundByMachine(cache_size)) {
      text << "four fifths of the " << GigabytesText(budget.machine_bytes)
           << " that this machine gives";
    } else {
      text << OptionName("cache_size") + " " << cache_size;
    }
    return text.str();
  }

  // The largest maps for which the machine's memory is enough, in a bracket.
  std::string WhatFits(int64_t machine_bytes,
                       int64_t needed,
                       size_t num_workers) const {
    constexpr int64_t kMegapixel = 1000000;
    // What does not grow with the maps makes this too many at first.
    auto megapixels = static_cast<int64_t>(
        Gigabytes(machine_bytes) / Gigabytes(needed) *
        static_cast<double>(overview_.max_num_pixels / kMegapixel));
    for (; megapixels > 0; --megapixels) {
      WorkspaceOverview smaller = overview_;
      smaller.max_num_pixels = megapixels * kMegapixel;
      if (BytesBeside(smaller, num_workers, make_sizes_(1, num_workers)) +
              BytesForViews(smaller) <=
          machine_bytes) {
        return " (maps of " + std::to_string(megapixels) + " megapixels fit)";
      }
    }
    return "";
  }

  const WorkspaceOverview& overview_;
  const int num_images_;
  const int num_cpu_workers_;
  PipelineSizes (*const make_sizes_)(int, size_t);
};

}  // namespace

GpuSystem GpuSystem::Cuda() {
  return {&Device::NumCudaDevices,
          &Device::CreateCuda,
          &Device::PrepareCudaDevices};
}

RefineDevices CreateRefineDevices(const DeviceOptions& options,
                                  const WorkspaceOverview& overview,
                                  int num_images,
                                  const GpuSystem& gpus,
                                  int64_t machine_bytes) {
  const int num_threads =
      options.num_threads > 0
          ? options.num_threads
          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const MemoryBudget budget(options.cache_size, machine_bytes);
  RefineDevices result;
  std::vector<Gpu> opened = OpenGpus(options, overview, num_images, gpus);
  if (opened.empty()) {
    const int num_workers = NumCpuWorkers(overview,
                                          num_images,
                                          budget.num_bytes,
                                          std::min(num_threads, num_images));
    AddCpuWorkers(num_workers, overview, num_threads, &result);
    MemoryDivision(overview, num_images, num_workers, CpuSizes)
        .Divide(budget,
                options.cache_size,
                (num_workers + kCpuWorkersPerFilesThread - 1) /
                    kCpuWorkersPerFilesThread,
                &result);
    return result;
  }
  const int max_num_files_threads = std::min(
      num_images, kFilesThreadsPerGpu * static_cast<int>(opened.size()));
  AddDevices(num_images, gpus, &opened);
  AddGpuWorkers(std::move(opened), overview, &result);
  result.finds_scenes_ahead = true;
  MemoryDivision(overview, num_images, 0, GpuSizes)
      .Divide(budget,
              options.cache_size,
              // As many write as read, and the workers copy.
              std::clamp(num_threads * 2 / 5, 1, max_num_files_threads),
              &result);
  return result;
}

std::vector<RunSummary::GpuMemory> PeakGpuMemory(const RefineDevices& devices) {
  std::vector<RunSummary::GpuMemory> peaks;
  for (const RefineWorker& worker : devices.workers) {
    const size_t num_bytes = worker.device->PeakMemory();
    if (num_bytes > 0 && (peaks.empty() || peaks.back().gpu != worker.name)) {
      peaks.push_back({worker.name, num_bytes});
    }
  }
  return peaks;
}

}  // namespace tsar
