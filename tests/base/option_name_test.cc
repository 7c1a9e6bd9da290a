// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/option_name.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(OptionName, IsTheKeyUntilSomebodyNamesOptions) {
  EXPECT_EQ(OptionName("device"), "device");
  SetOptionNamer([](const std::string& key) { return "--Group." + key; });
  EXPECT_EQ(OptionName("device"), "--Group.device");
  SetOptionNamer({});
  EXPECT_EQ(OptionName("device"), "device");
}

}  // namespace
}  // namespace tsar
