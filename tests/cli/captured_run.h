// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {

struct Outcome {
  int exit_code;
  std::string out;
  std::string err;
};

// Calls main(argc, argv) with this program name and these arguments, and keeps
// what it prints.
template <typename Main>
Outcome RunCaptured(const std::string& name,
                    std::vector<std::string> arguments,
                    const Main& main) {
  arguments.insert(arguments.begin(), name);
  std::vector<char*> argv;
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = main(static_cast<int>(argv.size()), argv.data());
  return {exit_code,
          testing::internal::GetCapturedStdout(),
          testing::internal::GetCapturedStderr()};
}

}  // namespace tsar
