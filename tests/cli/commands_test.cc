// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/cli/process_setup.h"

#include <iostream>
#include <new>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/cli/command_test.h"
#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <unistd.h>

namespace tsar {
namespace {

std::string ErrorOf(CommandFunction function) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunCommand(function, 0, nullptr), 1);
  return testing::internal::GetCapturedStderr();
}

TEST(Commands, HaveUniqueNamesSummariesAndFunctions) {
  std::set<std::string> names;
  for (const Command& command : Commands()) {
    EXPECT_TRUE(names.insert(command.name).second) << command.name;
    EXPECT_FALSE(command.summary.empty()) << command.name;
    EXPECT_NE(command.run, nullptr) << command.name;
  }
  EXPECT_EQ(names.count("tsar_evaluate"), 1u);
}

TEST(RunProgram, HelpListsAllCommands) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{}, {"help"}, {"-h"}, {"--help"}}) {
    const Outcome outcome = RunWith(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    for (const Command& command : Commands()) {
      EXPECT_NE(outcome.out.find(command.name), std::string::npos);
    }
  }
}

TEST(RunProgram, HelpExplainsACommandAsTheCommandDoes) {
  for (const Command& command : Commands()) {
    const Outcome outcome = RunWith({"help", command.name});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out, RunWith({command.name, "--help"}).out);
    EXPECT_FALSE(outcome.out.empty());
  }
  EXPECT_EQ(RunWith({"help", "tsar_evaluate", "depth"}).out,
            RunWith({"tsar_evaluate", "depth", "--help"}).out);
  const Outcome unknown = RunWith({"help", "tsar_refin"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("did you mean tsar_refine?"), std::string::npos);
}

TEST(RunProgram, ShortHelpFitsAScreen) {
  std::vector<std::vector<std::string>> commands = {
      {}, {"tsar_evaluate", "depth"}, {"tsar_evaluate", "cloud"}};
  for (const Command& command : Commands()) {
    commands.push_back({command.name});
  }
  for (std::vector<std::string> arguments : commands) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    std::vector<std::string> json_arguments = arguments;
    arguments.emplace_back("-h");
    json_arguments.emplace_back("--help_json");
    const std::string text = RunWith(arguments).out;
    std::istringstream lines(text);
    int num_lines = 0;
    for (std::string line; std::getline(lines, line); ++num_lines) {
      EXPECT_LE(line.size(), 80u) << line;
    }
    EXPECT_LE(num_lines, 24);
    EXPECT_GE(num_lines, 6);
    const nlohmann::json json =
        nlohmann::json::parse(RunWith(json_arguments).out);
    if (!json.contains("options")) {
      continue;
    }
    int num_shown = 0;
    for (const nlohmann::json& option : json["options"]) {
      const std::string name = "  --" + option["name"].get<std::string>() + " ";
      const bool is_shown = text.find("\n" + name) != std::string::npos;
      num_shown += is_shown ? 1 : 0;
      EXPECT_TRUE(is_shown || !option["required"].get<bool>()) << name;
    }
    EXPECT_GE(num_shown, 4);
    EXPECT_NE(text.find(json["command"].get<std::string>() + " --help\n"),
              std::string::npos);
  }
}

// What the manual pages and completions are made of.
TEST(RunProgram, HelpAsJsonOfTheProgramAndOfEveryCommand) {
  const nlohmann::json json =
      nlohmann::json::parse(RunWith({"--help_json"}).out);
  ASSERT_EQ(json.at("commands").size(), Commands().size());
  for (size_t i = 0; i < Commands().size(); ++i) {
    const std::string& name = Commands()[i].name;
    EXPECT_EQ(json.at("commands")[i].at("name"), name);
    const Outcome outcome = RunWith({name, "--help_json"});
    EXPECT_EQ(outcome.exit_code, 0);
    const nlohmann::json command = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(command.at("command"), name);
    if (!command.contains("forms")) {
      EXPECT_FALSE(command.at("options").empty());
      continue;
    }
    for (const nlohmann::json& form : command.at("forms")) {
      const nlohmann::json told = nlohmann::json::parse(
          RunWith({name, form.at("name"), "--help_json"}).out);
      EXPECT_FALSE(told.at("options").empty());
    }
  }
}

TEST(RunProgram, VersionSaysWhetherCudaIsBuiltIn) {
  const Outcome outcome = RunWith({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out.find("colmap_tsar "), 0u);
  EXPECT_NE(outcome.out.find("CUDA"), std::string::npos);
}

TEST(RunProgram, UnknownCommandIsOneLineWithTheNearestAndAllCommands) {
  const Outcome outcome = RunWith({"tsar_evaluat"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err.find("ERROR: unknown command 'tsar_evaluat'; did you "
                             "mean tsar_evaluate? The commands are "),
            0u);
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1);
  for (const char* name : {"refine", "rfine", "tsar-refine", "tsar_refien"}) {
    EXPECT_NE(RunWith({name}).err.find("did you mean tsar_refine?"),
              std::string::npos)
        << name;
  }
  EXPECT_EQ(RunWith({"stereo_fusion"}).err.find("did you mean"),
            std::string::npos);
}

TEST(RunCommand, PassesTheExitCodeOn) {
  EXPECT_EQ(RunCommand([](int, char**) { return 7; }, 0, nullptr), 7);
}

TEST(RunCommand, PrintsOurErrorsAsTheyAre) {
  EXPECT_EQ(ErrorOf([](int, char**) -> int {
              throw Error(ErrorCode::kIo, "a.bin: disk full; make room");
            }),
            "ERROR: a.bin: disk full; make room\n");
}

TEST(RunCommand, PrintsForeignErrorsOnOneLine) {
  EXPECT_EQ(
      ErrorOf([](int, char**) -> int { throw std::runtime_error("one\ntwo"); }),
      "ERROR: unexpected failure: one two\n");
}

TEST(RunCommand, PrintsWhatNoTerminalObeys) {
  EXPECT_EQ(ErrorOf([](int, char**) -> int {
              throw Error(ErrorCode::kIo,
                          "a\xC2\x9B"
                          "2J\x1b.png\x9B: caf\xC3\xA9");
            }),
            "ERROR: a?2J?.png?: caf\xC3\xA9\n");
}

TEST(RunCommand, SaysThatMemoryDidNotSuffice) {
  const std::string text =
      "ERROR: out of memory; close other programs or work on smaller images\n";
  EXPECT_EQ(ErrorOf([](int, char**) -> int { throw std::bad_alloc(); }), text);
  EXPECT_EQ(
      ErrorOf([](int, char**) -> int { CV_Error(cv::Error::StsNoMem, "no"); }),
      text);
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

// The system would end this program otherwise.
TEST(RunCommand, AFileThatGrowsTooLargeIsAnError) {
  struct sigaction before = {};
  sigaction(SIGXFSZ, nullptr, &before);
  EXPECT_EQ(RunCommand([](int, char**) { return raise(SIGXFSZ); }, 0, nullptr),
            0);
  struct sigaction after = {};
  sigaction(SIGXFSZ, nullptr, &after);
  EXPECT_EQ(after.sa_handler, before.sa_handler);
}

// In a process of its own, since this one needs its streams.
TEST(RunCommand, OpensClosedStreamsToNothing) {
  EXPECT_EXIT(
      {
        close(STDIN_FILENO);
        close(STDOUT_FILENO);
        const int exit_code = RunCommand(
            [](int, char**) {
              const int file = open("/dev/zero", O_RDONLY | O_CLOEXEC);
              char byte = 0;
              return file > STDERR_FILENO &&
                             read(STDIN_FILENO, &byte, 1) == 0 &&
                             write(STDOUT_FILENO, "x", 1) == 1
                         ? 17
                         : 18;
            },
            0,
            nullptr);
        _exit(exit_code);
      },
      testing::ExitedWithCode(17),
      "");
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
