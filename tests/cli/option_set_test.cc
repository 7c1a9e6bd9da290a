// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tsar {
namespace {

class OptionSetTest : public testing::Test {
 protected:
  OptionSetTest() {
    options_.AddRequired("workspace_path", &workspace_path_, "The workspace.");
    options_.Add("output_path", &output_path_, "Where to write to.");
    options_.Add("TsarTest.iterations", &iterations_, "N_t.", {1, 10});
    options_.Add("TsarTest.bytes", &bytes_, "Bytes.");
    options_.Add("TsarTest.score", &score_, "eta.", {0, 1});
    options_.Add("TsarTest.sigma", &sigma_, "alpha.");
    options_.Add("TsarTest.filter", &filter_, "On or off.");
    options_.AddChoice(
        "TsarTest.device", &device_, {"auto", "cpu", "cuda"}, "Where to run.");
    Option edges{"edges", "Steps.", &edges_, {0, 1}};
    edges.presets["paper"] = "2";
    options_.AddSettings("TsarTest.experiment",
                         &experiment_,
                         {edges, {"rounds", "Rounds.", &rounds_, {1, 10}}},
                         "For experiments.");
  }

  ~OptionSetTest() override {
    std::error_code ignored;
    std::filesystem::remove(ini_path_, ignored);
  }

  bool Parse(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv = {"/usr/bin/colmap"};
    for (const std::string& argument : arguments) {
      argv.push_back(argument.c_str());
    }
    return options_.Parse(static_cast<int>(argv.size()), argv.data());
  }

  // Parses with the required option given.
  bool ParseMore(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--workspace_path", "dense"});
    return Parse(arguments);
  }

  // The message with which parsing fails.
  std::string Failure(const std::vector<std::string>& arguments,
                      ErrorCode code = ErrorCode::kBadOption) {
    try {
      Parse(arguments);
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), code) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }

  std::string FailureWith(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--workspace_path", "dense"});
    return Failure(arguments);
  }

  std::string WriteIni(const std::string& content) {
    ini_path_ =
        testing::TempDir() + "option_set_" + std::to_string(getpid()) + "_" +
        testing::UnitTest::GetInstance()->current_test_info()->name() + ".ini";
    std::ofstream(ini_path_) << content;
    return ini_path_;
  }

  OptionSet options_{"tsar_test", "Tests options.", "tsar_test --x"};
  std::filesystem::path workspace_path_;
  std::filesystem::path output_path_;
  std::string ini_path_;
  int iterations_ = 4;
  int64_t bytes_ = -1;
  float score_ = 0.8f;
  double sigma_ = 2.0;
  bool filter_ = true;
  std::string device_ = "auto";
  std::string experiment_;
  double edges_ = 1.0;
  int rounds_ = 4;
};

TEST_F(OptionSetTest, KeepsDefaultsOfWhatIsNotGiven) {
  EXPECT_TRUE(ParseMore({}));
  EXPECT_EQ(workspace_path_, "dense");
  EXPECT_EQ(iterations_, 4);
  EXPECT_EQ(device_, "auto");
}

TEST_F(OptionSetTest, ReadsEveryTypeInBothSpellings) {
  EXPECT_TRUE(ParseMore({"--TsarTest.iterations",
                         "7",
                         "--TsarTest.bytes=-9000000000",
                         "--TsarTest.score",
                         "0.25",
                         "--TsarTest.sigma",
                         "-1e-3",
                         "--TsarTest.filter=0",
                         "--TsarTest.device",
                         "cpu",
                         "--output_path=--odd name"}));
  EXPECT_EQ(iterations_, 7);
  EXPECT_EQ(bytes_, -9000000000);
  EXPECT_EQ(score_, 0.25f);
  EXPECT_EQ(sigma_, -1e-3);
  EXPECT_FALSE(filter_);
  EXPECT_EQ(device_, "cpu");
  EXPECT_EQ(output_path_, "--odd name");
}

TEST_F(OptionSetTest, ReadsTrueAndFalse) {
  EXPECT_TRUE(ParseMore({"--TsarTest.filter", "false"}));
  EXPECT_FALSE(filter_);
  EXPECT_TRUE(ParseMore({"--TsarTest.filter", "true"}));
  EXPECT_TRUE(filter_);
}

TEST_F(OptionSetTest, SettingsSetWhatTheyName) {
  EXPECT_TRUE(ParseMore({"--TsarTest.experiment", "edges=0.25,rounds=7"}));
  EXPECT_EQ(edges_, 0.25);
  EXPECT_EQ(rounds_, 7);
  EXPECT_TRUE(ParseMore(
      {"--project_path", WriteIni("[TsarTest]\nexperiment = edges=0.5\n")}));
  EXPECT_EQ(edges_, 0.5);
}

TEST_F(OptionSetTest, WrongSettingsAreNamedWithTheNearest) {
  const std::string option = "--TsarTest.experiment";
  EXPECT_EQ(FailureWith({option, "edge=1"}),
            option + ": there is no 'edge'; did you mean edges? " + option +
                " help lists all");
  EXPECT_EQ(FailureWith({option, "zzzzzzzz=1"}),
            option + ": there is no 'zzzzzzzz'; " + option + " help lists all");
  EXPECT_EQ(FailureWith({option, "edges"}),
            option + ": 'edges' is not of the form name=value");
  EXPECT_EQ(FailureWith({option, "edges=1,edges=2"}),
            option + ": edges is given twice; give it once");
  EXPECT_EQ(FailureWith({option, "rounds=11"}),
            option + " rounds: 11 is too large; give at most 10");
}

TEST_F(OptionSetTest, HelpOfSettingsListsThem) {
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Parse({"--TsarTest.experiment", "help"}));
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("edges NUMBER (default: 1; paper: 2)\n      Steps.\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("rounds INT (default: 4)\n"), std::string::npos) << text;
}

TEST_F(OptionSetTest, UnknownOptionNamesItAndTheNearest) {
  EXPECT_EQ(FailureWith({"--TsarTest.iteration", "3"}),
            "unknown option --TsarTest.iteration; did you mean "
            "--TsarTest.iterations? See tsar_test --help");
  EXPECT_EQ(FailureWith({"--iterations=3"}),
            "unknown option --iterations; did you mean --TsarTest.iterations? "
            "See tsar_test --help");
  EXPECT_EQ(FailureWith({"--zzzzzzzz"}),
            "unknown option --zzzzzzzz; see tsar_test --help");
}

TEST_F(OptionSetTest, PrefixesOfOptionsAreUnknownOptions) {
  EXPECT_EQ(FailureWith({"--TsarTest.dev", "cpu"})
                .find("unknown option --TsarTest.dev;"),
            0u);
}

TEST_F(OptionSetTest, MissingValueNamesTheOption) {
  const std::string expected =
      "--TsarTest.device has no value; give one, or see tsar_test --help";
  EXPECT_EQ(FailureWith({"--TsarTest.device"}), expected);
  EXPECT_EQ(FailureWith({"--TsarTest.device", "--TsarTest.filter", "0"}),
            expected);
  EXPECT_EQ(FailureWith({"--TsarTest.device", "--TsarTest.misspelled", "0"}),
            expected);
}

TEST_F(OptionSetTest, StrayArgumentsAreErrors) {
  const std::string advice =
      "; options begin with two dashes, see tsar_test --help";
  EXPECT_EQ(FailureWith({"dense2"}), "unexpected argument 'dense2'" + advice);
  EXPECT_EQ(FailureWith({"-x"}), "unexpected argument '-x'" + advice);
}

TEST_F(OptionSetTest, GivingAnOptionTwiceIsAnError) {
  EXPECT_EQ(FailureWith({"--TsarTest.filter", "0", "--TsarTest.filter", "1"}),
            "--TsarTest.filter is given twice; give it once");
}

TEST_F(OptionSetTest, MissingRequiredOptionIsNamed) {
  const std::string expected =
      "--workspace_path is missing; give it as --workspace_path PATH, or see "
      "tsar_test --help";
  EXPECT_EQ(Failure({}), expected);
  EXPECT_EQ(Failure({"--workspace_path="}).find("--workspace_path "), 0u);
}

TEST_F(OptionSetTest, UnparsableValuesNameOptionAndValue) {
  EXPECT_EQ(FailureWith({"--TsarTest.iterations", "3x"}),
            "--TsarTest.iterations: '3x' is not a whole number; give one such "
            "as 3");
  EXPECT_EQ(FailureWith({"--TsarTest.iterations", "99999999999"}),
            "--TsarTest.iterations: '99999999999' is out of range; give a "
            "smaller number");
  EXPECT_EQ(FailureWith({"--TsarTest.sigma", "nan"}),
            "--TsarTest.sigma: 'nan' is not a number; give one such as 0.5");
  EXPECT_EQ(FailureWith({"--TsarTest.sigma", "inf"}),
            "--TsarTest.sigma: 'inf' is not a number; give one such as 0.5");
  EXPECT_EQ(FailureWith({"--TsarTest.filter", "yes"}),
            "--TsarTest.filter: 'yes' is not a switch; give 0 or 1");
  EXPECT_EQ(FailureWith({"--TsarTest.device", "gpu"}),
            "--TsarTest.device: 'gpu' is not known; give one of auto, cpu, "
            "cuda");
  EXPECT_EQ(iterations_, 4);
  EXPECT_EQ(device_, "auto");
}

TEST_F(OptionSetTest, ValuesOutsideTheRangeAreErrors) {
  EXPECT_EQ(FailureWith({"--TsarTest.iterations", "0"}),
            "--TsarTest.iterations: 0 is too small; give at least 1");
  EXPECT_EQ(FailureWith({"--TsarTest.score", "1.5"}),
            "--TsarTest.score: 1.5 is too large; give at most 1");
  EXPECT_TRUE(ParseMore({"--TsarTest.score", "1"}));
}

TEST_F(OptionSetTest, HelpWinsOverEverythingAndTouchesNothing) {
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Parse({"--TsarTest.iterations", "9", "--wrong", "--help"}));
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_EQ(iterations_, 4);
  for (const char* part : {"Tests options.",
                           "colmap tsar_test --workspace_path PATH [options]",
                           "Example:\n  colmap tsar_test --x\n",
                           "--workspace_path PATH (required)",
                           "--TsarTest.iterations INT (default: 4)",
                           "--TsarTest.device auto|cpu|cuda (default: auto)",
                           "--TsarTest.filter 0|1 (default: 1)",
                           "--project_path",
                           "N_t."}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  // Less of it, and nothing where both were asked for.
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Parse({"--wrong", "-h"}));
  const std::string brief = testing::internal::GetCapturedStdout();
  EXPECT_LT(brief.size(), text.size());
  EXPECT_NE(brief.find("tsar_test --help\n"), std::string::npos);
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Parse({"-h", "--help"}));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), text);
}

TEST_F(OptionSetTest, HelpAsJsonTellsTheSameToPrograms) {
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Parse({"--TsarTest.iterations", "9", "--wrong", "--help_json"}));
  const nlohmann::json json =
      nlohmann::json::parse(testing::internal::GetCapturedStdout());
  EXPECT_EQ(iterations_, 4);
  EXPECT_EQ(json.at("command"), "tsar_test");
  EXPECT_EQ(json.at("summary"), "Tests options.");
  std::map<std::string, nlohmann::json> options;
  for (const nlohmann::json& option : json.at("options")) {
    options[option.at("name")] = option;
  }
  EXPECT_EQ(options.size(), 11u);
  EXPECT_EQ(options.at("workspace_path"),
            nlohmann::json({{"name", "workspace_path"},
                            {"value", "PATH"},
                            {"choices", nlohmann::json::array()},
                            {"is_path", true},
                            {"required", true},
                            {"default", ""},
                            {"description", "The workspace."}}));
  EXPECT_EQ(options.at("TsarTest.device").at("choices"),
            nlohmann::json({"auto", "cpu", "cuda"}));
  EXPECT_EQ(options.at("TsarTest.device").at("is_path"), false);
  EXPECT_EQ(options.at("TsarTest.filter").at("choices"),
            nlohmann::json({"0", "1"}));
  EXPECT_EQ(options.at("TsarTest.iterations").at("default"), "4");
  EXPECT_EQ(options.at("project_path").at("is_path"), true);
  const nlohmann::json settings =
      options.at("TsarTest.experiment").at("settings");
  EXPECT_EQ(settings.at(0).at("name"), "edges");
  EXPECT_EQ(settings.at(0).at("presets"), nlohmann::json({{"paper", "2"}}));
  EXPECT_EQ(settings.at(1).at("max"), 10.0);
}

TEST_F(OptionSetTest, IniFillsInWhatTheCommandLineLeavesOut) {
  const std::string ini = WriteIni(
      "workspace_path = from_ini\noutput_path = out\n"
      "# a comment\n[TsarTest]\niterations = 6\ndevice=cuda\n");
  EXPECT_TRUE(Parse({"--project_path", ini, "--TsarTest.iterations", "8"}));
  EXPECT_EQ(workspace_path_, "from_ini");
  EXPECT_EQ(output_path_, "out");
  EXPECT_EQ(iterations_, 8);
  EXPECT_EQ(device_, "cuda");
}

TEST_F(OptionSetTest, IniOfColmapIsAccepted) {
  const std::string ini = WriteIni(
      "log_to_stderr=false\nlog_level=2\nrandom_seed=0\n"
      "database_path=/a/database.db\nimage_path=/a/images\n"
      "[PatchMatchStereo]\nwindow_radius=5\n[StereoFusion]\nmin_num_pixels=5\n"
      "[TsarTest]\nfilter=0\n");
  EXPECT_TRUE(ParseMore({"--project_path", ini}));
  EXPECT_FALSE(filter_);
}

TEST_F(OptionSetTest, IniWithAnUnknownKeyOfOursIsAnError) {
  std::string ini = WriteIni("[TsarTest]\niteration = 6\n");
  EXPECT_EQ(FailureWith({"--project_path", ini}),
            ini +
                ": unknown key TsarTest.iteration; did you mean "
                "--TsarTest.iterations? See tsar_test --help");
  ini = WriteIni("workspace_pth = dense\n");
  EXPECT_EQ(FailureWith({"--project_path", ini}),
            ini +
                ": unknown key workspace_pth; did you mean "
                "--workspace_path? See tsar_test --help");
}

TEST_F(OptionSetTest, IniWithABadValueIsAnErrorThatNamesTheFile) {
  std::string ini = WriteIni("[TsarTest]\nscore = much\n");
  EXPECT_EQ(FailureWith({"--project_path", ini}),
            ini +
                ": TsarTest.score: 'much' is not a number; give one such as "
                "0.5");
  ini = WriteIni("[TsarTest]\nscore = 0.1\nscore = 0.2\n");
  EXPECT_EQ(FailureWith({"--project_path", ini}),
            ini + ": key TsarTest.score is given twice; give it once");
}

TEST_F(OptionSetTest, UnreadableIniIsAnError) {
  const std::string missing = testing::TempDir() + "no_such_file.ini";
  EXPECT_EQ(Failure({"--project_path", missing}, ErrorCode::kNotFound),
            missing +
                ": there is no such file; give --project_path an ini "
                "file");
  Failure({"--project_path", testing::TempDir()}, ErrorCode::kNotFound);
  const std::string ini = WriteIni("this is not an ini file\n");
  EXPECT_EQ(Failure({"--project_path", ini}, ErrorCode::kCorrupt)
                .find(ini + ": not an ini file ("),
            0u);
}

}  // namespace
}  // namespace tsar
