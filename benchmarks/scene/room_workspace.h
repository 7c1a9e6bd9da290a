// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"

#include <cstdint>
#include <filesystem>
#include <functional>

namespace tsar {

struct RoomWorkspaceOptions {
  int width = 3110;
  int height = 2073;
  int num_images = 12;
  // For each image; all other images if there are fewer.
  int num_sources = 10;
  uint32_t seed = 1;
};

// Renders the room and writes it as a dense workspace that patch_match_stereo,
// tsar_refine and stereo_fusion accept, with maps of both types as they are
// after patch_match_stereo, and with ground_truth/depth/NAME.bin. The same
// options give the same bytes with any number of threads. Calls advance after
// each image. Throws what the writers of maps throw.
void WriteRoomWorkspace(const std::filesystem::path& root,
                        const RoomWorkspaceOptions& options,
                        ThreadPool& threads,
                        const std::function<void()>& advance);

}  // namespace tsar
