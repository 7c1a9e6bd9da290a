// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/controllers/gpu_workers.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fused_cloud_writer.h"
#include "colmap_tsar/fusion/fusion_neighbours.h"
#include "colmap_tsar/fusion/fusion_view_cache.h"
#include "colmap_tsar/store/count_masks.h"
#include "colmap_tsar/store/for_each_image.h"
#include "colmap_tsar/store/workspace_lock.h"
#include "colmap_tsar/workspace/image_list.h"
#include "colmap_tsar/workspace/map_io.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <thread>
#include <utility>

namespace tsar {
namespace {

constexpr int64_t kPixelBytes = sizeof(FusionPixel);

std::vector<bool> ReadListed(const Workspace& workspace,
                             const std::filesystem::path& list,
                             const std::string& option) {
  std::vector<bool> listed(workspace.Model().images.size(), list.empty());
  if (!list.empty()) {
    for (const ListedImage& image :
         ReadImageList(list, workspace.Model(), option)) {
      listed[static_cast<size_t>(image.image)] = true;
    }
  }
  return listed;
}

ChosenImages ChooseImages(const Workspace& workspace,
                          const std::filesystem::path& list) {
  const std::filesystem::path config =
      workspace.Root() / "stereo" / "fusion.cfg";
  ChosenImages chosen;
  chosen.used = ReadListed(workspace,
                           Exists(config) ? config : std::filesystem::path(),
                           "fusion.cfg");
  chosen.fused = ReadListed(workspace, list, OptionName("image_list_path"));
  for (size_t i = 0; i < chosen.used.size(); ++i) {
    chosen.fused[i] = chosen.fused[i] && chosen.used[i];
  }
  return chosen;
}

class WorkspaceFuser {
 public:
  WorkspaceFuser(const Workspace& workspace,
                 const FuseWorkspaceOptions& options,
                 Progress& progress,
                 const std::function<bool()>& should_stop)
      : workspace_(workspace),
        options_(options),
        progress_(progress),
        should_stop_(should_stop),
        plan_(PlanFusion(workspace,
                         ChooseImages(workspace, options.image_list_path),
                         options.fusion.check_num_images)),
        cache_(
            CacheBytes(),
            [this](int image) { return NumPixels(image); },
            [this](int image) {
              return LoadFusionView(
                  workspace_, image, plan_.matched[static_cast<size_t>(image)]);
            }) {
    MeasureImages();
    OpenDevices();
  }

  FuseSummary Run() {
    const Stopwatch stopwatch;
    FusedCloudWriter writer(UserPath(options_.output_path));
    progress_.Start(static_cast<int>(plan_.order.size()), "Fusion:");
    for (size_t begin = 0; begin < plan_.order.size();) {
      const std::vector<int> group = GroupFrom(begin);
      for (const EncodedPoints& points : FuseGroup(group)) {
        StopIfAsked();
        writer.Add(points);
        progress_.Advance(/*was_work=*/true);
      }
      begin += group.size();
    }
    StopIfAsked();
    writer.Commit();
    progress_.Finish();
    summary_.num_images = static_cast<int>(plan_.order.size());
    summary_.num_masks = CountMasks(workspace_, plan_.order);
    summary_.num_points = writer.NumPoints();
    summary_.seconds = stopwatch.Seconds();
    for (const GpuWorkers& gpu : gpus_) {
      summary_.gpu_memory.push_back({gpu.name, gpu.devices[0]->PeakMemory()});
    }
    return std::move(summary_);
  }

 private:
  int64_t CacheBytes() const {
    return std::min(static_cast<int64_t>(1e9 * options_.devices.cache_size),
                    MainMemoryBytes() / 5 * 4);
  }

  int64_t NumPixels(int image) const {
    return num_pixels_[static_cast<size_t>(image)];
  }

  // Of all images that are used.
  void MeasureImages() {
    num_pixels_.assign(workspace_.Model().images.size(), 0);
    for (const int image : plan_.order) {
      for (const int needed : ImagesOf(image)) {
        int64_t& num_pixels = num_pixels_[static_cast<size_t>(needed)];
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

  void OpenDevices() {
    MemoryPlan memory;
    const int64_t max_bytes = kPixelBytes * max_width_ * max_height_;
    for (const int image : plan_.order) {
      memory.num_sources = std::max(
          memory.num_sources,
          static_cast<int>(plan_.sources[static_cast<size_t>(image)].size()));
    }
    memory.work =
        FuseViewWorkingBytes(max_width_, max_height_, options_.fusion) +
        max_bytes;
    memory.uploaded_view = max_bytes;
    gpus_ = OpenGpus(options_.devices,
                     memory,
                     static_cast<int>(plan_.order.size()),
                     GpuSystem::Cuda());
    for (const GpuWorkers& gpu : gpus_) {
      summary_.devices += (summary_.devices.empty() ? "" : ", ") + gpu.name;
      for (const std::unique_ptr<Device>& device : gpu.devices) {
        devices_.emplace_back(*device, gpu.bytes_per_device - memory.work);
      }
    }
    if (devices_.empty()) {
      cpu_ = Device::CreateCpu(options_.devices.num_threads);
      summary_.devices =
          std::to_string(cpu_->Threads().NumThreads()) + " CPU threads";
      devices_.emplace_back(*cpu_, 0);
    }
  }

  // The image and those that it is compared with.
  std::vector<int> ImagesOf(int image) const {
    std::vector<int> images = {image};
    const std::vector<int>& sources = plan_.sources[static_cast<size_t>(image)];
    images.insert(images.end(), sources.begin(), sources.end());
    return images;
  }

  // Images that are fused side by side: as many as the memory holds with those
  // that they are compared with, and no more than keep all threads at work.
  std::vector<int> GroupFrom(size_t begin) {
    const size_t max_size =
        2 * std::max<size_t>(devices_.size(),
                             std::max(1u, std::thread::hardware_concurrency()));
    std::vector<int> group;
    std::vector<bool> is_needed(num_pixels_.size(), false);
    int64_t num_bytes = 0;
    needed_.clear();
    for (size_t i = begin; i < plan_.order.size() && group.size() < max_size;
         ++i) {
      std::vector<int> added;
      // With its points, of which there are at most as many as pixels.
      int64_t num_new_bytes = kPixelBytes * NumPixels(plan_.order[i]);
      for (const int image : ImagesOf(plan_.order[i])) {
        if (!is_needed[static_cast<size_t>(image)]) {
          added.push_back(image);
          num_new_bytes += kPixelBytes * NumPixels(image);
        }
      }
      if (!group.empty() && num_bytes + num_new_bytes > CacheBytes()) {
        break;
      }
      for (const int image : added) {
        is_needed[static_cast<size_t>(image)] = true;
        needed_.push_back(image);
      }
      num_bytes += num_new_bytes;
      group.push_back(plan_.order[i]);
    }
    return group;
  }

  std::vector<EncodedPoints> FuseGroup(const std::vector<int>& group) {
    cache_.Hold(
        needed_, [&](size_t count, const std::function<void(size_t)>& load) {
          std::vector<int> images(count, group[0]);
          ForEachImage(
              workspace_, images, options_.devices.num_threads, [&](size_t i) {
                StopIfAsked();
                load(i);
              });
        });
    std::vector<EncodedPoints> results(group.size());
    std::atomic<size_t> next = 0;
    ThreadPool threads(
        static_cast<int>(std::min(devices_.size(), group.size())));
    threads.Run(
        static_cast<int64_t>(devices_.size()), [&](int64_t begin, int64_t end) {
          for (int64_t d = begin; d < end; ++d) {
            for (size_t i = next++; i < group.size(); i = next++) {
              StopIfAsked();
              results[i] = Fuse(group[i], &devices_[static_cast<size_t>(d)]);
            }
          }
        });
    return results;
  }

  EncodedPoints Fuse(int image, FusionDevice* device) {
    const std::vector<int> images = ImagesOf(image);
    const std::vector<FusionInput> inputs = device->Use(images, cache_);
    std::vector<FusionSourceInput> sources;
    std::vector<int> source_places;
    for (size_t i = 1; i < images.size(); ++i) {
      const auto source = static_cast<size_t>(images[i]);
      sources.push_back(
          {inputs[i], plan_.places[source] >= 0, plan_.places[source]});
      source_places.push_back(workspace_.Model().images[source].place_in_file);
    }
    const auto place = static_cast<size_t>(image);
    const std::vector<FusedPoint> points = FuseView(inputs[0],
                                                    plan_.places[place],
                                                    sources,
                                                    options_.fusion,
                                                    device->GetDevice());
    return EncodePoints(points,
                        inputs[0].camera,
                        options_.bounding_box,
                        workspace_.Model().images[place].place_in_file,
                        source_places);
  }

  void StopIfAsked() const {
    if (should_stop_()) {
      throw Error(ErrorCode::kInterrupted, "interrupted; no cloud was written");
    }
  }

  const Workspace& workspace_;
  const FuseWorkspaceOptions& options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const FusionPlan plan_;
  std::vector<int64_t> num_pixels_;  // By image; 0 where it is not used.
  int max_width_ = 0;
  int max_height_ = 0;
  FusionViewCache cache_;
  std::vector<int> needed_;  // By the group at work.
  std::vector<GpuWorkers> gpus_;
  std::unique_ptr<Device> cpu_;
  // After the devices whose memory they hold.
  std::vector<FusionDevice> devices_;
  FuseSummary summary_;
};

}  // namespace

Eigen::AlignedBox3d ReadBoundingBox(const std::filesystem::path& path) {
  InputFile file(path);
  if (!file) {
    throw Error::File(file.IsMissing() ? ErrorCode::kNotFound : ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + file.Reason() + ")",
                      "check " + OptionName("bounding_box_path"));
  }
  Eigen::AlignedBox3d box;
  for (Eigen::Vector3d* corner : {&box.min(), &box.max()}) {
    for (int i = 0; i < 3; ++i) {
      file >> (*corner)[i];
    }
  }
  if (!file || !(box.min().array() <= box.max().array()).all()) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "does not hold the six numbers of a box",
                      "write the smallest x, y and z, then the largest");
  }
  return box;
}

FuseSummary FuseWorkspace(Workspace workspace,
                          const FuseWorkspaceOptions& options,
                          Progress& progress,
                          const std::function<bool()>& should_stop) {
  options.fusion.Check();
  workspace.UseMasks(options.mask_path);
  // So that the maps of an image belong together.
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  return WorkspaceFuser(workspace, options, progress, should_stop).Run();
}

}  // namespace tsar
