// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/commands.h"

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>
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

// Runs the program with these arguments.
inline Outcome RunWith(const std::vector<std::string>& arguments) {
  return RunCaptured("colmap_tsar", arguments, &RunProgram);
}

// Runs a command as COLMAP does.
template <CommandFunction kCommand>
Outcome RunCommandWith(const std::vector<std::string>& arguments) {
  return RunCaptured("colmap", arguments, [](int argc, char** argv) {
    return RunCommand(kCommand, argc, argv);
  });
}

// A command that works on the workspace root_ in a folder of its own.
template <CommandFunction kCommand>
class CommandTest : public testing::Test {
 protected:
  using Words = std::vector<std::string>;

  Outcome Run(Words arguments) const {
    arguments.insert(arguments.end(), {"--workspace_path", root_.string()});
    arguments.insert(arguments.end(), always_.begin(), always_.end());
    return RunCommandWith<kCommand>(arguments);
  }

  // Expects exit code 1, an error with these texts as the last line, only
  // progress before it, and no changed file.
  void ExpectFailure(const Words& arguments, const Words& texts) const {
    const auto before = ReadTree(folder_.Path());
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    const size_t error = outcome.err.find("ERROR: ");
    ASSERT_NE(error, std::string::npos) << outcome.err;
    EXPECT_TRUE(error == 0 || outcome.err.find('[') < error) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n', error), outcome.err.size() - 1)
        << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_THAT(outcome.err.substr(error), testing::HasSubstr(text));
    }
    EXPECT_TRUE(ReadTree(folder_.Path()) == before);
  }
  void ExpectFailure(const Words& arguments, const char* text) const {
    ExpectFailure(arguments, Words{text});
  }

  // Arguments of every call, besides --workspace_path.
  Words always_;
  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

}  // namespace tsar
