// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_run.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <limits>
#include <thread>

namespace tsar {
namespace {

// The standard deviation of a matched depth, in pixels of disparity.
constexpr float kPixelsOfDisparity = 0.25f;

constexpr int64_t kPixelBytes = sizeof(FusionPixel);

// More take no less time and more memory: each keeps views of its own.
constexpr int kImagesPerGpu = 4;

constexpr const char* kStopped = "interrupted; nothing was written";

// The maps of an image without masked pixels. sources: images of the same
// scene, by index in the sparse model; their baselines give the precision of
// depths without a sigma. Depths without a confidence map have full confidence.
// Errors as ReadImageMaps() and Workspace::ReadImage().
FusionView LoadFusionView(const Workspace& workspace,
                          int image,
                          const std::vector<int>& sources) {
  const ImageMaps maps = ReadImageMaps(workspace, image, /*with_labels=*/false);
  const int width = maps.depth.Width();
  const int height = maps.depth.Height();
  const Image<Rgb> color = workspace.ReadImage(image, width, height);
  const auto camera_of = [&](int i) -> const Camera& {
    return workspace.Model().images[i].camera;
  };
  FusionView view{camera_of(image).Resized(width, height), {width, height}};
  std::vector<Camera> cameras;
  for (const int source : sources) {
    cameras.push_back(camera_of(source));
  }
  const DepthResolution resolution =
      ComputeDisparityScale(view.camera, cameras);
  for (size_t i = 0; i < maps.depth.NumPixels(); ++i) {
    const float depth = maps.depth.Data()[i];
    if (!(depth > 0.f)) {
      continue;
    }
    FusionPixel& pixel = view.pixels.Data()[i];
    pixel.depth = depth;
    EncodeNormal(maps.normal.Data()[i], &pixel);
    pixel.color = color.Data()[i];
    pixel.confidence = maps.confidence.Empty()
                           ? std::numeric_limits<uint8_t>::max()
                           : std::max(maps.confidence.Data()[i], uint8_t{1});
    const float sigma = maps.sigma.Empty() ? 0.f : maps.sigma.Data()[i];
    pixel.sigma =
        EncodeSigma(sigma > 0.f ? sigma / depth
                                : kPixelsOfDisparity *
                                      resolution.RelativeDepthError(depth));
  }
  return view;
}

}  // namespace

std::vector<FusionInput> FusionDevice::Use(const std::vector<int>& images,
                                           const FusionViews& views) {
  if (device_.IsCuda()) {
    in_use_.clear();
    in_use_ = copies_.GetAll(
        images,
        [&](int image) {
          return std::make_shared<const DeviceImage<FusionPixel>>(
              device_, views.at(image)->pixels);
        },
        [] { return false; });
  }
  std::vector<FusionInput> inputs;
  for (size_t i = 0; i < images.size(); ++i) {
    const FusionView& view = *views.at(images[i]);
    inputs.push_back(
        {view.camera,
         device_.IsCuda() ? in_use_[i]->View() : view.pixels.View()});
  }
  return inputs;
}

FusionRun::FusionRun(const Workspace& workspace,
                     const FusionPlan& plan,
                     const FusionOptions& fusion,
                     const DeviceOptions& devices)
    : workspace_(workspace),
      plan_(plan),
      fusion_(fusion),
      device_options_(devices),
      max_group_bytes_(MainMemoryBudget(devices.cache_size, MainMemoryBytes()) /
                       2) {
  MeasureImages();
  OpenDevices();
}

void FusionRun::Run(const UsePoints& use,
                    const Finish& finish,
                    Progress& progress) {
  progress.Start(static_cast<int>(plan_.order.size()), "Fusion:");
  Group group = GroupFrom(0);
  FusionViews views = Load(group, {}, progress);
  while (group.begin < group.end) {
    const Group next = GroupFrom(group.end);
    std::packaged_task<FusionViews()> load_next(
        [&] { return Load(next, views, progress); });
    std::future<FusionViews> next_views = load_next.get_future();
    // Reading takes the CPU longer than fusing takes the GPUs.
    const bool is_concurrent = cpu_ == nullptr;
    std::jthread loader;
    if (is_concurrent) {
      loader = StartThread([&] { load_next(); });
    }
    FuseGroup(group, views, use, progress);
    for (size_t i = group.begin; i < group.end; ++i) {
      finish(i);
    }
    if (!is_concurrent) {
      load_next();
    }
    views = next_views.get();
    group = next;
  }
  progress.ThrowIfStopped(kStopped);
  progress.Finish();
}

void FusionRun::FuseGroup(const Group& group,
                          const FusionViews& views,
                          const UsePoints& use,
                          Progress& progress) {
  std::atomic<size_t> next = group.begin;
  ThreadPool threads(
      static_cast<int>(std::min(devices_.size(), group.end - group.begin)));
  threads.Run(static_cast<int64_t>(devices_.size()),
              [&](int64_t begin, int64_t end) {
                for (int64_t d = begin; d < end; ++d) {
                  for (size_t i = next++; i < group.end; i = next++) {
                    progress.ThrowIfStopped(kStopped);
                    use(i, Fuse(plan_.order[i], views, &devices_[d]));
                    progress.Advance(/*was_work=*/true);
                  }
                }
              });
}

std::vector<RunSummary::GpuMemory> FusionRun::PeakGpuMemory() const {
  std::vector<RunSummary::GpuMemory> peaks;
  for (const GpuWorkers& gpu : gpus_) {
    peaks.push_back({gpu.name, gpu.devices[0]->PeakMemory()});
  }
  return peaks;
}

std::vector<int> FusionRun::ImagesOf(int image) const {
  std::vector<int> images = {image};
  images.insert(images.end(), SourcesOf(image).begin(), SourcesOf(image).end());
  return images;
}

void FusionRun::MeasureImages() {
  num_pixels_.assign(workspace_.Model().images.size(), 0);
  for (const int image : plan_.order) {
    for (const int needed : ImagesOf(image)) {
      int64_t& num_pixels = num_pixels_[needed];
      if (num_pixels == 0) {
        const MapSize size =
            ReadMapSize(workspace_.Paths(needed, workspace_.Type()).depth);
        num_pixels = int64_t{size.width} * size.height;
        max_width_ = std::max(max_width_, size.width);
        max_height_ = std::max(max_height_, size.height);
      }
    }
  }
}

void FusionRun::OpenDevices() {
  const int64_t view_bytes = kPixelBytes * max_width_ * max_height_;
  size_t num_views = 0;  // Of an image with its sources.
  for (const int image : plan_.order) {
    num_views = std::max(num_views, ImagesOf(image).size());
  }
  // The points twice, and their flags and sums with the memory of the scan.
  const int64_t work =
      (int64_t{max_width_} * max_height_ * (2 * sizeof(FusedPoint) + 16)) /
          (fusion_.point_spacing * fusion_.point_spacing) +
      (1 << 22);
  gpus_ = OpenGpus(device_options_,
                   work + static_cast<int64_t>(num_views) * view_bytes,
                   static_cast<int>(plan_.order.size()),
                   kImagesPerGpu,
                   GpuSystem::Cuda());
  for (const GpuWorkers& gpu : gpus_) {
    description_ += (description_.empty() ? "" : ", ") + gpu.name;
    for (const std::unique_ptr<Device>& device : gpu.devices) {
      devices_.emplace_back(
          *device,
          static_cast<size_t>((gpu.bytes_per_device - work) / view_bytes));
    }
  }
  if (devices_.empty()) {
    cpu_ = Device::CreateCpu(device_options_.num_threads);
    description_ =
        std::to_string(cpu_->Threads().NumThreads()) + " CPU threads";
    devices_.emplace_back(*cpu_, 0);
  }
}

int64_t FusionRun::ResultBytes(int image) const {
  constexpr int64_t kEncodedBytes = 32;
  const auto num_sources = static_cast<int64_t>(SourcesOf(image).size());
  return num_pixels_[image] / (fusion_.point_spacing * fusion_.point_spacing) *
         (2 * static_cast<int64_t>(sizeof(FusedPoint)) + kEncodedBytes +
          4 * (1 + num_sources));
}

FusionRun::Group FusionRun::GroupFrom(size_t begin) const {
  const size_t max_size =
      std::max(devices_.size(), static_cast<size_t>(NumThreads(-1)));
  Group group = {begin, begin, {}};
  std::vector<bool> is_needed(num_pixels_.size(), false);
  int64_t num_bytes = 0;
  for (size_t i = begin; i < std::min(begin + max_size, plan_.order.size());
       ++i) {
    std::vector<int> added;
    int64_t num_new_bytes = ResultBytes(plan_.order[i]);
    for (const int image : ImagesOf(plan_.order[i])) {
      if (!is_needed[image]) {
        added.push_back(image);
        num_new_bytes += kPixelBytes * num_pixels_[image];
      }
    }
    if (i > begin && num_bytes + num_new_bytes > max_group_bytes_) {
      break;
    }
    for (const int image : added) {
      is_needed[image] = true;
      group.needed.push_back(image);
    }
    num_bytes += num_new_bytes;
    group.end = i + 1;
  }
  return group;
}

FusionViews FusionRun::Load(const Group& group,
                            const FusionViews& loaded,
                            Progress& progress) const {
  FusionViews views;
  std::vector<int> missing;
  for (const int image : group.needed) {
    const auto found = loaded.find(image);
    if (found == loaded.end()) {
      missing.push_back(image);
    }
    views[image] = found == loaded.end() ? nullptr : found->second;
  }
  ForEachImage(workspace_, missing, device_options_.num_threads, [&](size_t i) {
    progress.ThrowIfStopped(kStopped);
    const int image = missing[i];
    views.at(image) = std::make_shared<const FusionView>(
        LoadFusionView(workspace_, image, SourcesOf(image)));
  });
  return views;
}

FusedImage FusionRun::Fuse(int image,
                           const FusionViews& views,
                           FusionDevice* device) const {
  const std::vector<FusionInput> inputs = device->Use(ImagesOf(image), views);
  std::vector<FusionSourceInput> sources;
  for (size_t i = 1; i < inputs.size(); ++i) {
    const int source = SourcesOf(image)[i - 1];
    const std::vector<int>& asked = SourcesOf(source);
    const int place = plan_.places[source];
    sources.push_back(
        {inputs[i],
         place >= 0 &&
             std::find(asked.begin(), asked.end(), image) != asked.end(),
         place});
  }
  return {image,
          views.at(image).get(),
          FuseView(inputs[0],
                   plan_.places[image],
                   sources,
                   fusion_,
                   device->GetDevice())};
}

}  // namespace tsar
