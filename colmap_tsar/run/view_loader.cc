// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/view_loader.h"

#include "colmap_tsar/run/load_view.h"

#include <memory>

namespace tsar {

std::shared_ptr<const ViewData> ViewLoader::Load(int image) {
  const std::unique_lock<std::mutex> lock = Lock(image);
  return std::make_shared<const ViewData>(LoadView(workspace_, image));
}

std::shared_ptr<const ViewData> ViewLoader::LoadReduced(int image) {
  const std::unique_lock<std::mutex> lock = Lock(image);
  return std::make_shared<const ViewData>(LoadReducedView(workspace_, image));
}

}  // namespace tsar
