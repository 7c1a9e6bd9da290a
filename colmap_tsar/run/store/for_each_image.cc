// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/for_each_image.h"

#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/device/thread_pool.h"

#include <algorithm>
#include <cstdint>
#include <thread>

namespace tsar {
namespace {

int NumThreads(const Workspace& workspace,
               const std::vector<int>& images,
               int num_threads) {
  // The memory of an image's maps and of the results.
  constexpr int64_t kBytesPerPixel = 60;
  int64_t num_pixels = 1;
  for (const int image : images) {
    const Camera& camera =
        workspace.Model().images[static_cast<size_t>(image)].camera;
    num_pixels = std::max(num_pixels,
                          static_cast<int64_t>(camera.width) * camera.height);
  }
  const int64_t room = MainMemoryBytes() / 2 / (kBytesPerPixel * num_pixels);
  const int64_t wanted =
      num_threads > 0
          ? num_threads
          : static_cast<int64_t>(std::thread::hardware_concurrency());
  return static_cast<int>(std::max<int64_t>(1, std::min(wanted, room)));
}

}  // namespace

void ForEachImage(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads,
                  const std::function<void(size_t)>& function) {
  ThreadPool threads(NumThreads(workspace, images, num_threads));
  threads.ForEach(images.size(), function);
}

}  // namespace tsar
