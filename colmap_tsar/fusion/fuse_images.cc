// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_images.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/pipeline_devices.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace tsar {
namespace {

// The standard deviation of a matched depth, in pixels of disparity.
constexpr float kPixelsOfDisparity = 0.25f;

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

// The image at this place of the order, and its sources.
std::vector<int> ImagesAt(const FusionPlan& plan, size_t place) {
  const int image = plan.order[place];
  std::vector<int> images = {image};
  images.insert(
      images.end(), plan.sources[image].begin(), plan.sources[image].end());
  return images;
}

// The largest number of views that so many images in a row need together.
size_t MaxNumViews(const FusionPlan& plan, size_t num_images) {
  std::vector<size_t> last_row(plan.sources.size(), plan.order.size());
  size_t max = 0;
  size_t count = 0;
  for (size_t place = 0; place < plan.order.size(); ++place) {
    const size_t row = place / num_images;
    count = place % num_images == 0 ? 0 : count;
    for (const int image : ImagesAt(plan, place)) {
      count += std::exchange(last_row[image], row) != row ? 1 : 0;
    }
    max = std::max(max, count);
  }
  return max;
}

// The sizes of the images and maps that are used. Throws what ReadMapSize
// throws.
WorkspaceOverview OverviewOf(const Workspace& workspace,
                             const FusionPlan& plan) {
  std::set<int> images;
  for (size_t place = 0; place < plan.order.size(); ++place) {
    const std::vector<int> used = ImagesAt(plan, place);
    images.insert(used.begin(), used.end());
  }
  WorkspaceOverview overview;
  for (const int image : images) {
    const MapSize size =
        ReadMapSize(workspace.Paths(image, workspace.Type()).depth);
    overview.max_num_pixels =
        std::max(overview.max_num_pixels, int64_t{size.width} * size.height);
    const Camera& camera = workspace.Model().images[image].camera;
    overview.max_num_image_pixels = std::max(
        overview.max_num_image_pixels, int64_t{camera.width} * camera.height);
  }
  return overview;
}

// The memory of an image at work, where the images in a row that work at the
// same time share their views.
MemoryPlan PlanMemory(const Workspace& workspace,
                      const FusionPlan& plan,
                      const FusionOptions& fusion,
                      const DeviceOptions& devices) {
  const WorkspaceOverview overview = OverviewOf(workspace, plan);
  const auto num_views = static_cast<int64_t>(MaxNumViews(plan, 1));
  const int64_t view_bytes =
      static_cast<int64_t>(sizeof(FusionPixel)) * overview.max_num_pixels;
  const int64_t max_num_points =
      overview.max_num_pixels / (fusion.point_spacing * fusion.point_spacing);
  constexpr int64_t kPointBytes = sizeof(FusedPoint);
  constexpr int64_t kFlagBytes = 16;  // With their sums.
  // In the files, besides the images that see the point.
  constexpr int64_t kEncodedBytes = 32;
  MemoryPlan memory;
  memory.num_sources = static_cast<int>(num_views) - 1;
  memory.copies = num_views * view_bytes;
  const int64_t work =
      (1 << 22) + max_num_points * (2 * kPointBytes + kFlagBytes);
  memory.device = memory.copies + work;
  memory.advice =
      "give a smaller " + OptionName("check_num_images") + ", or smaller maps";
  const int64_t result =
      max_num_points * (kPointBytes + kEncodedBytes + 4 * num_views) +
      ReadAndWriteBytes(overview);
  const int64_t budget =
      MainMemoryBudget(devices.cache_size, MainMemoryBytes());
  for (int64_t n = NumThreads(devices.num_threads); n > 0; --n) {
    memory.views =
        static_cast<int64_t>(MaxNumViews(plan, static_cast<size_t>(n))) *
        view_bytes / n;
    memory.main = memory.views + result;
    if (n * (memory.main + work) <= budget) {
      break;
    }
  }
  return memory;
}

class FusionPass : public ImagePass<FusedImage, FusionView> {
 public:
  // max_num_views: of the images that are at work at the same time.
  FusionPass(const Workspace& workspace,
             const FusionPlan& plan,
             const FusionOptions& fusion,
             const std::vector<PipelineWorker>& workers,
             size_t max_num_views,
             const UsePoints& use)
      : workspace_(workspace),
        plan_(plan),
        fusion_(fusion),
        workers_(workers),
        use_(use) {
    std::map<std::string, size_t> num_workers;
    for (const PipelineWorker& worker : workers) {
      ++num_workers[worker.name];
    }
    const size_t views_of_image = MaxNumViews(plan, 1);
    // As many copies as the workers' memory was planned for.
    for (const auto& [gpu, count] : num_workers) {
      copies_.try_emplace(gpu, std::min(max_num_views, count * views_of_image));
    }
  }

  ImageReport Begin(size_t /*place*/) override { return {}; }

  std::vector<int> Views(size_t place) const override {
    return ImagesAt(plan_, place);
  }

  std::shared_ptr<const FusionView> Load(int image) const override {
    return std::make_shared<const FusionView>(
        LoadFusionView(workspace_, image, plan_.sources[image]));
  }

  FusedImage Compute(size_t place,
                     size_t worker,
                     ViewsAtWork<FusionView>* views,
                     ImageReport* /*report*/) override {
    const int image = plan_.order[place];
    Device& device = *workers_[worker].device;
    const std::vector<int> images = ImagesAt(plan_, place);
    std::vector<Copies::Pointer> copies;
    const ScopedSynchronization before_copies_are_released(device);
    if (device.IsCuda()) {
      const auto copy_to_gpu = [&](int i) {
        auto copy = std::make_shared<const DeviceImage<FusionPixel>>(
            device, views->Get(i).pixels);
        device.Synchronize();
        return copy;
      };
      copies =
          copies_.at(workers_[worker].name).GetAll(images, copy_to_gpu, [] {
            return false;
          });
    }
    const auto input = [&](size_t i) -> FusionInput {
      const FusionView& view = views->Get(images[i]);
      return {view.camera,
              device.IsCuda() ? copies[i]->View() : view.pixels.View()};
    };
    std::vector<FusionSourceInput> sources;
    for (size_t i = 1; i < images.size(); ++i) {
      const std::vector<int>& asked = plan_.sources[images[i]];
      const int source_place = plan_.places[images[i]];
      sources.push_back(
          {input(i),
           source_place >= 0 &&
               std::find(asked.begin(), asked.end(), image) != asked.end(),
           source_place});
    }
    return {views->Share(image),
            FuseView(input(0), plan_.places[image], sources, fusion_, device)};
  }

  void Write(size_t place, FusedImage fused, ImageReport* report) override {
    use_(place, fused);
    report->outcome = ImageReport::Outcome::kDone;
  }

 private:
  using Copies = SharedCache<DeviceImage<FusionPixel>>;

  const Workspace& workspace_;
  const FusionPlan& plan_;
  const FusionOptions& fusion_;
  const std::vector<PipelineWorker>& workers_;
  const UsePoints& use_;
  std::map<std::string, Copies> copies_;  // By the GPU's name.
};

}  // namespace

FusionDevices FuseImages(const Workspace& workspace,
                         const FusionPlan& plan,
                         const FusionOptions& fusion,
                         const DeviceOptions& devices,
                         const UsePoints& use,
                         Progress& progress) {
  const MemoryPlan memory = PlanMemory(workspace, plan, fusion, devices);
  const PipelineDevices opened =
      OpenPipelineDevices(devices, memory, static_cast<int>(plan.order.size()));
  const ImagesAtWork& at_work = opened.at_work;
  const size_t max_num_views =
      MaxNumViews(plan, static_cast<size_t>(at_work.num_threads));
  FusionPass pass(workspace, plan, fusion, opened.workers, max_num_views, use);
  std::vector<size_t> places(plan.order.size());
  std::iota(places.begin(), places.end(), size_t{0});
  const PipelineOutcome outcome =
      ImagePipeline<FusedImage, FusionView>(
          pass, places, "Fusion:", at_work, max_num_views, progress)
          .Run();
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    throw Error(ErrorCode::kInterrupted, "interrupted; nothing was written");
  }
  return {opened.description, PeakGpuMemory(opened)};
}

}  // namespace tsar
