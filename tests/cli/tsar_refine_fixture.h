// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "tests/cli/command_test.h"
#include <nlohmann/json.hpp>

namespace tsar {

class TsarRefineTest : public CommandTest<&RunTsarRefine> {
 protected:
  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    always_ = {"--TsarRefine.device", "cpu"};
  }

  nlohmann::json UsedOptions() const {
    return nlohmann::json::parse(
        ReadText(root_ / "stereo/tsar/manifest.json"))["options"];
  }
};

}  // namespace tsar
