// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/test_workspace.h"

namespace tsar {

// Writes refined maps into the test workspace.
class WriteBackTest : public testing::Test {
 protected:
  void SetUp() override;

  static ImageRecord Record(const std::string& options_hash = "options");
  float CurrentDepth(int image);
  float OriginalDepth(int image);
  // Made when first used, after SetUp.
  const Workspace& workspace();

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "dense";
  std::optional<Workspace> workspace_;
};

}  // namespace tsar
