// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/cli/process_setup.h"

#include <iostream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/cli/command_test.h"
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <unistd.h>

namespace tsar {
namespace {

using Words = std::vector<std::string>;

std::string ErrorOf(CommandFunction function) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunCommand(function, 0, nullptr), 1);
  return testing::internal::GetCapturedStderr();
}

TEST(RunProgram, HelpListsAllCommands) {
  for (const Words& arguments :
       {Words{}, {"help"}, {"-h"}, {"--help"}, {"--help_json"}}) {
    const Outcome outcome = RunWith(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    for (const Command& command : Commands()) {
      EXPECT_THAT(outcome.out, testing::HasSubstr(command.name));
      EXPECT_THAT(outcome.out, testing::HasSubstr(command.summary));
    }
  }
}

// The help of every command, or of every form of one.
TEST(RunProgram, HelpFitsTwoScreensAndTellsOfAllOptions) {
  std::vector<Words> commands;
  for (const Command& command : Commands()) {
    const auto json =
        nlohmann::json::parse(RunWith({command.name, "--help_json"}).out);
    EXPECT_EQ(json.at("command"), command.name);
    for (const nlohmann::json& form :
         json.value("forms", nlohmann::json::array())) {
      commands.push_back({command.name, form.at("name")});
    }
    if (!json.contains("forms")) {
      commands.push_back({command.name});
    }
  }
  EXPECT_GT(commands.size(), Commands().size());
  for (const Words& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto printed = [&](const char* option) {
      Words arguments = command;
      arguments.emplace_back(option);
      return RunWith(arguments).out;
    };
    const std::string help = printed("--help");
    std::istringstream lines(help);
    int num_lines = 0;
    for (std::string line; std::getline(lines, line); ++num_lines) {
      EXPECT_LE(line.size(), 100u) << line;
    }
    EXPECT_LE(num_lines, 100);
    const std::string all = printed("--help_all");
    const auto json = nlohmann::json::parse(printed("--help_json"));
    EXPECT_GT(json.at("options").size(), 4u);
    for (const nlohmann::json& option : json.at("options")) {
      const std::string name =
          "\n  --" + option.at("name").get<std::string>() + " ";
      EXPECT_THAT(all, testing::HasSubstr(name));
      EXPECT_EQ(help.find(name) == std::string::npos,
                option.at("advanced").get<bool>())
          << name;
    }
  }
}

TEST(RunProgram, VersionSaysWhetherCudaIsBuiltIn) {
  EXPECT_THAT(RunWith({"--version"}).out,
              testing::ContainsRegex("^colmap_tsar .*CUDA"));
}

TEST(RunProgram, AnUnknownCommandIsOneLineWithAllCommands) {
  const Outcome outcome = RunWith({"tsar_evaluat"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err,
              testing::MatchesRegex("ERROR: unknown command 'tsar_evaluat'; "
                                    "the commands are tsar_reconstruct, .*\n"));
}

TEST(RunCommand, PrintsEveryErrorOnOneLineThatNoTerminalObeys) {
  const std::string memory =
      "out of memory; close other programs or work on smaller images";
  const std::pair<CommandFunction, std::string> failures[] = {
      {[](int, char**) -> int {
         throw Error(ErrorCode::kIo, "a.bin: disk full; make room");
       },
       "a.bin: disk full; make room"},
      {[](int, char**) -> int { throw std::runtime_error("one\ntwo"); },
       "unexpected failure: one two"},
      {[](int, char**) -> int {
         throw Error(ErrorCode::kIo,
                     "a\xC2\x9B"
                     "2J\x1b.png\x9B: caf\xC3\xA9");
       },
       "a?2J?.png?: caf\xC3\xA9"},
      {[](int, char**) -> int { throw std::bad_alloc(); }, memory},
      {[](int, char**) -> int { CV_Error(cv::Error::StsNoMem, "no"); }, memory},
  };
  for (const auto& [function, text] : failures) {
    EXPECT_EQ(ErrorOf(function), "ERROR: " + text + "\n");
  }
}

TEST(RunCommand, SaysWhereStandardOutputCannotBeWritten) {
  const int before = dup(STDOUT_FILENO);
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  dup2(full, STDOUT_FILENO);
  const std::string text = ErrorOf([](int, char**) {
    std::cout << "a result\n";
    return 0;
  });
  dup2(before, STDOUT_FILENO);
  close(before);
  close(full);
  EXPECT_EQ(text,
            "ERROR: standard output: what was printed is lost (No space left "
            "on device); check where it leads to\n");
  EXPECT_TRUE(std::cout);
}

TEST(RunCommandDeathTest, AFailureThatNothingCatchesIsOneLine) {
  struct FailingCleanup {
    static void Fail() { throw std::bad_alloc(); }
    ~FailingCleanup() { Fail(); }
  };
  EXPECT_EXIT(
      {
        ReportUncaughtFailures();
        const FailingCleanup cleanup;
      },
      testing::ExitedWithCode(1),
      "^ERROR: out of memory; close other programs or work on smaller "
      "images\n$");
  EXPECT_EXIT(
      {
        ReportUncaughtFailures();
        std::thread([] { throw std::runtime_error("one\ntwo"); }).join();
      },
      testing::ExitedWithCode(1),
      "^ERROR: unexpected failure: one two\n$");
}

}  // namespace
}  // namespace tsar
