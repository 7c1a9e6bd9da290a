// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>

#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Words = std::vector<std::string>;

class OptionSetTest : public testing::Test {
 protected:
  OptionSetTest() {
    options_.AddRequired("workspace_path", &workspace_path_, "The workspace.");
    options_.Add("output_path", &output_path_, "Where to write to.");
    options_.Add("TsarTest.iterations", &iterations_, "N_t.", {1, 10});
    options_.Add("TsarTest.score", &score_, "eta.", {0, 1});
    options_.Add("TsarTest.sigma", &sigma_, "alpha.").is_advanced = true;
    options_.Add("TsarTest.filter", &filter_, "On or off.");
    options_.Add("TsarTest.device", &device_, "Where to run.").choices = {
        "auto", "cpu", "cuda"};
  }

  bool Parse(const Words& arguments) {
    std::vector<const char*> argv = {"/usr/bin/colmap"};
    for (const std::string& argument : arguments) {
      argv.push_back(argument.c_str());
    }
    return options_.Parse(static_cast<int>(argv.size()), argv.data());
  }

  // Parses with the required option given.
  bool ParseMore(Words arguments) {
    arguments.insert(arguments.begin(), {"--workspace_path", "dense"});
    return Parse(arguments);
  }

  // Expects that parsing fails with one line that contains this text.
  void ExpectFailure(const Words& arguments,
                     const std::string& text,
                     ErrorCode code = ErrorCode::kBadOption) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    try {
      ParseMore(arguments);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), code) << error.what();
      EXPECT_THAT(error.what(), testing::HasSubstr(text));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }

  std::string Ini(const std::string& content) const {
    WriteText(ini_, content);
    return ini_.string();
  }

  std::string Printed(const Words& arguments) {
    testing::internal::CaptureStdout();
    EXPECT_FALSE(Parse(arguments));
    return testing::internal::GetCapturedStdout();
  }

  const TemporaryFolder folder_;
  const std::filesystem::path ini_ = folder_.Path() / "project.ini";
  OptionSet options_{"tsar_test", "Tests options.", "tsar_test --x"};
  std::filesystem::path workspace_path_;
  std::filesystem::path output_path_;
  int iterations_ = 4;
  float score_ = 0.8f;
  double sigma_ = 2.0;
  bool filter_ = true;
  std::string device_ = "auto";
};

TEST_F(OptionSetTest, ReadsEveryTypeInBothSpellingsAndKeepsOtherDefaults) {
  EXPECT_TRUE(ParseMore({"--TsarTest.iterations",
                         "7",
                         "--TsarTest.score=1",
                         "--TsarTest.sigma",
                         "-1e-3",
                         "--TsarTest.filter=0",
                         "--output_path=--odd name"}));
  EXPECT_EQ(workspace_path_, "dense");
  EXPECT_EQ(iterations_, 7);
  EXPECT_EQ(score_, 1.f);
  EXPECT_EQ(sigma_, -1e-3);
  EXPECT_FALSE(filter_);
  EXPECT_EQ(device_, "auto");
  EXPECT_EQ(output_path_, "--odd name");
  EXPECT_TRUE(ParseMore({"--TsarTest.filter", "true"}));
  EXPECT_TRUE(filter_);
}

TEST_F(OptionSetTest, WrongArgumentsAreOneLineThatNamesThem) {
  const std::pair<Words, std::string> failures[] = {
      {{"--TsarTest.iteration", "3"},
       "unknown option --TsarTest.iteration (did you mean "
       "--TsarTest.iterations?); see tsar_test --help"},
      {{"--iterations=3"},
       "unknown option --iterations (did you mean --TsarTest.iterations?"},
      {{"--zzzzzzzz", "3"}, "unknown option --zzzzzzzz; see tsar_test --help"},
      {{"--TsarTest.dev", "cpu"}, "unknown option --TsarTest.dev ("},
      {{"--TsarTest.device"}, "'--TsarTest.device' is missing"},
      {{"--TsarTest.device", "--TsarTest.filter", "0"},
       "--TsarTest.device has no value; see"},
      {{"--TsarTest.device="}, "'--TsarTest.device' should follow"},
      {{"dense2"}, "unexpected argument 'dense2'"},
      {{"-x"}, "unexpected argument '-x', options begin with two dashes"},
      {{"--TsarTest.filter", "0", "--TsarTest.filter", "1"},
       "'--TsarTest.filter' cannot be specified more than once"},
      {{"--TsarTest.iterations", "3x"},
       "--TsarTest.iterations: '3x' is not a whole number from 1 to 10"},
      {{"--TsarTest.iterations", "0"},
       "--TsarTest.iterations: '0' is not a whole number from 1 to 10"},
      {{"--TsarTest.iterations", "99999999999"},
       "'99999999999' is not a whole number from 1 to 10"},
      {{"--TsarTest.score", "1.5"},
       "--TsarTest.score: '1.5' is not a number from 0 to 1"},
      {{"--TsarTest.sigma", "nan"}, "--TsarTest.sigma: 'nan' is not a number"},
      {{"--TsarTest.sigma", "inf"}, "--TsarTest.sigma: 'inf' is not a number"},
      {{"--TsarTest.filter", "yes"}, "--TsarTest.filter: 'yes' is not 0 or 1"},
      {{"--TsarTest.device", "gpu"},
       "--TsarTest.device: 'gpu' is not one of auto, cpu, cuda"},
  };
  for (const auto& [arguments, text] : failures) {
    ExpectFailure(arguments, text);
  }
  EXPECT_EQ(iterations_, 4);
  for (const Words& arguments : {Words{}, {"--workspace_path", ""}}) {
    workspace_path_.clear();
    try {
      Parse(arguments);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(),
                   "--workspace_path is missing; give it as --workspace_path "
                   "PATH; see tsar_test --help");
    }
  }
}

TEST_F(OptionSetTest, HelpWinsOverEverythingAndTouchesNothing) {
  const std::string text =
      Printed({"--TsarTest.iterations", "9", "--wrong", "--help"});
  EXPECT_EQ(iterations_, 4);
  for (const char* part : {"Tests options.",
                           "colmap tsar_test --workspace_path PATH [options]",
                           "Example:\n  colmap tsar_test --x\n",
                           "--TsarTest.iterations INT (=4)",
                           "--TsarTest.device auto|cpu|cuda (=auto)",
                           "--TsarTest.filter 0|1 (=1)",
                           "--project_path",
                           "N_t."}) {
    EXPECT_THAT(text, testing::HasSubstr(part));
  }
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("sigma")));
  EXPECT_EQ(Printed({"-h"}), text);
  EXPECT_THAT(Printed({"--help_all"}),
              testing::HasSubstr("--TsarTest.sigma NUMBER (=2)"));
}

// The manual, the completions and the Python module are made from it.
TEST_F(OptionSetTest, HelpAsJsonTellsAllToPrograms) {
  const auto json = nlohmann::json::parse(
      Printed({"--TsarTest.iterations", "9", "--wrong", "--help_json"}));
  EXPECT_EQ(iterations_, 4);
  EXPECT_EQ(json.at("command"), "tsar_test");
  EXPECT_EQ(json.at("summary"), "Tests options.");
  const nlohmann::json& options = json.at("options");
  ASSERT_EQ(options.size(), 11u);
  EXPECT_EQ(options[2],
            nlohmann::json({{"name", "TsarTest.iterations"},
                            {"value", "INT"},
                            {"choices", nlohmann::json::array()},
                            {"is_path", false},
                            {"required", false},
                            {"advanced", false},
                            {"default", "4"},
                            {"max", 10.0},
                            {"description", "N_t."}}));
  EXPECT_EQ(options[0].at("required"), true);
  EXPECT_EQ(options[0].at("is_path"), true);
  EXPECT_EQ(options[4].at("advanced"), true);
  EXPECT_EQ(options[5].at("choices"), nlohmann::json({"0", "1"}));
  EXPECT_EQ(options[6].at("choices"), nlohmann::json({"auto", "cpu", "cuda"}));
  EXPECT_EQ(options[7].at("name"), "project_path");
}

TEST_F(OptionSetTest, IniOfColmapFillsInWhatTheCommandLineLeavesOut) {
  const std::string ini =
      Ini("log_to_stderr=false\nlog_level=2\nrandom_seed=0\n"
          "database_path=/a/database.db\nimage_path=/a/images\n"
          "workspace_path = from an ini\n# a comment\n[PatchMatchStereo]\n"
          "window_radius=5\n[TsarTest]\niterations = 6\ndevice=cuda\n");
  // All commands of COLMAP have these three.
  EXPECT_TRUE(Parse({"--log_level",
                     "2",
                     "--random_seed",
                     "1",
                     "--log_to_stderr",
                     "0",
                     "--project_path",
                     ini,
                     "--TsarTest.iterations",
                     "8"}));
  EXPECT_EQ(workspace_path_, "from an ini");
  EXPECT_EQ(iterations_, 8);
  EXPECT_EQ(device_, "cuda");
}

TEST_F(OptionSetTest, WrongInisAreOneLineThatNamesTheFile) {
  const std::pair<const char*, std::string> failures[] = {
      {"[TsarTest]\niteration = 6\n",
       "unknown option TsarTest.iteration (did you mean "
       "--TsarTest.iterations?"},
      {"[TsarTest]\nscore = much\n",
       "TsarTest.score: 'much' is not a number from 0 to 1"},
      {"[TsarTest]\nscore = 0.1\nscore = 0.2\n",
       "'TsarTest.score' cannot be specified more than once"},
      {"this is not an ini file\n", "invalid line"},
  };
  for (const auto& [content, text] : failures) {
    const std::string ini = Ini(content);
    ExpectFailure({"--project_path", ini}, text);
    ExpectFailure({"--project_path", ini}, ini + ": ");
  }
  for (const std::filesystem::path& path :
       {folder_.Path() / "missing.ini", folder_.Path()}) {
    ExpectFailure({"--project_path", path.string()},
                  path.string() + ": cannot be read (",
                  ErrorCode::kNotFound);
  }
}

}  // namespace
}  // namespace tsar
