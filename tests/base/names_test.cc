// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/printable.h"

#include <string>
#include <utility>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

enum class Fruit { kApple, kPear, kPlum };

// Not in the order of the values, one of which has no name.
constexpr std::array kNames = {std::pair(Fruit::kPear, "pear"),
                               std::pair(Fruit::kApple, "apple")};

TEST(EnumNames, NamesAndFindsValues) {
  EXPECT_EQ(EnumName(kNames, Fruit::kApple), "apple");
  EXPECT_THROW(EnumName(kNames, Fruit::kPlum), std::invalid_argument);
  EXPECT_EQ(FindEnumValue(kNames, "pear"), Fruit::kPear);
  for (const char* text : {"", "pea", "pears", "Pear", "plum"}) {
    EXPECT_EQ(FindEnumValue(kNames, text), std::nullopt) << text;
  }
}

TEST(OptionName, IsTheKeyUntilSomebodyNamesOptions) {
  EXPECT_EQ(OptionName("device"), "device");
  SetOptionNamer([](const std::string& key) { return "--Group." + key; });
  EXPECT_EQ(OptionName("device"), "--Group.device");
  SetOptionNamer({});
  EXPECT_EQ(OptionName("device"), "device");
}

namespace fs = std::filesystem;

TEST(Path, TellsWhatIsThere) {
  const TemporaryFolder folder;
  const fs::path file = folder.Path() / "file";
  WriteText(file, "text");
  fs::create_symlink("file", folder.Path() / "link");
  fs::create_symlink("nowhere", folder.Path() / "dangling");
  for (const char* name : {"file", "link"}) {
    EXPECT_TRUE(Exists(folder.Path() / name)) << name;
    EXPECT_TRUE(IsFile(folder.Path() / name)) << name;
  }
  EXPECT_TRUE(Exists(folder.Path()));
  EXPECT_FALSE(IsFile(folder.Path()));
  for (const std::string& name : {std::string("missing"),
                                  std::string("dangling"),
                                  std::string("missing/too"),
                                  std::string("file/in"),
                                  std::string(300, 'x')}) {
    EXPECT_FALSE(Exists(folder.Path() / name)) << name;
    EXPECT_FALSE(IsFile(folder.Path() / name)) << name;
    EXPECT_EQ(fs::exists(SymlinkStatus(folder.Path() / name)),
              name == "dangling");
    EXPECT_EQ(AdviceForMissing(folder.Path() / name, "advice"),
              name == "dangling" ? "it is a link to nowhere, which is not "
                                   "there: put that back, or make the link anew"
                                 : "advice");
  }
}

// A loop of links cannot be resolved, not even by the superuser.
TEST(Path, WhatHasNoAnswerIsNotMissing) {
  const TemporaryFolder folder;
  const fs::path loop = folder.Path() / "loop";
  fs::create_symlink("loop", loop);
  for (const fs::path& path : {loop, loop / "in"}) {
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { Exists(path); });
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { IsFile(path); });
  }
}

TEST(Path, IsWithinAFolderByNamesAlone) {
  EXPECT_TRUE(IsWithin("/a/b", "/a/b"));
  EXPECT_TRUE(IsWithin("/a/b/c", "/a/b"));
  EXPECT_FALSE(IsWithin("/a/bc", "/a/b"));
  EXPECT_FALSE(IsWithin("/a", "/a/b"));
}

TEST(Printable, IsOneLineWithoutControlCharacters) {
  for (const auto& [text, expected] :
       {std::pair("", ""),
        std::pair("dense/images/v0.png: no such image; look",
                  "dense/images/v0.png: no such image; look"),
        std::pair("caf\xC3\xA9.jpg \xE9\x9B\xAA",
                  "caf\xC3\xA9.jpg \xE9\x9B\xAA"),
        std::pair("~\xC2\xA0\xF0\x9F\x93\xB7", "~\xC2\xA0\xF0\x9F\x93\xB7"),
        std::pair("a\nb\r\nc\td\ve\f", "a b  c d e "),
        std::pair("v\x1b[2J0.png\x07\x7f", "v?[2J0.png??"),
        std::pair("a\xC2\x9B"
                  "2Jb\xC2\x85"
                  "c",
                  "a?2Jb?c")}) {
    EXPECT_EQ(Printable(text), expected);
    EXPECT_EQ(HasControlCharacter(text), std::string(text) != expected);
  }
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a?b");
  // Invalid UTF-8, such as Latin-1, is replaced, and may occur in a name.
  for (const char* name : {"caf\xE9.jpg", "caf\x9B.jpg", "caf\xC2.jpg"}) {
    EXPECT_EQ(Printable(name), "caf?.jpg");
    EXPECT_FALSE(HasControlCharacter(name));
  }
}

TEST(ParseNumber, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(ParseNumber<double>("-1.5e3"), -1500.0);
  EXPECT_EQ(ParseNumber<int>("-7"), -7);
  EXPECT_EQ(ParseNumber<uint64_t>("18446744073709551615"), ~uint64_t{0});
  for (const char* text : {"",
                           " 1",
                           "1 ",
                           "+1",
                           "1x",
                           "1,5",
                           "1.5",
                           "1e9",
                           "x",
                           "-1",
                           "4294967296"}) {
    EXPECT_EQ(ParseNumber<uint32_t>(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace tsar
