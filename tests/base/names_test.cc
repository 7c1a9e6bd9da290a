// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/printable.h"

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>
#include <unistd.h>

namespace tsar {
namespace {

enum class Fruit { kApple, kPear, kPlum };

// Not in the order of the values, and one has no name.
constexpr std::array kNames = {std::pair(Fruit::kPear, "pear"),
                               std::pair(Fruit::kApple, "apple")};

TEST(EnumNames, NamesValues) {
  EXPECT_EQ(EnumName(kNames, Fruit::kApple), "apple");
  EXPECT_EQ(EnumName(kNames, Fruit::kPear), "pear");
  EXPECT_THROW(EnumName(kNames, Fruit::kPlum), std::invalid_argument);
}

TEST(EnumNames, FindsValuesByTheirWholeNames) {
  EXPECT_EQ(FindEnumValue(kNames, "pear"), Fruit::kPear);
  EXPECT_EQ(EnumValue(kNames, "apple"), Fruit::kApple);
  for (const char* text : {"", "pea", "pears", "Pear", "plum"}) {
    EXPECT_EQ(FindEnumValue(kNames, text), std::nullopt) << text;
    EXPECT_THROW(EnumValue(kNames, text), std::invalid_argument) << text;
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
  }
}

// A loop of links has no answer, not even for the superuser.
TEST(Path, WhatHasNoAnswerIsNotMissing) {
  const TemporaryFolder folder;
  const fs::path loop = folder.Path() / "loop";
  fs::create_symlink("loop", loop);
  for (const fs::path& path : {loop, loop / "in"}) {
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { Exists(path); });
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { IsFile(path); });
  }
}

TEST(Path, WhatMayNotBeLookedAtIsNotMissing) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "the superuser may look into every folder";
  }
  const TemporaryFolder folder;
  const fs::path closed = folder.Path() / "closed";
  fs::create_directory(closed);
  WriteText(closed / "file", "text");
  fs::permissions(closed, fs::perms::none);
  ExpectError(ErrorCode::kIo, {(closed / "file").string(), "denied"}, [&] {
    Exists(closed / "file");
  });
  fs::permissions(closed, fs::perms::owner_all);
}

TEST(Path, IsWithinAFolderByNamesAlone) {
  EXPECT_TRUE(IsWithin("/a/b", "/a/b"));
  EXPECT_TRUE(IsWithin("/a/b/c", "/a/b"));
  EXPECT_FALSE(IsWithin("/a/bc", "/a/b"));
  EXPECT_FALSE(IsWithin("/a", "/a/b"));
}

std::string Utf8(uint32_t code) {
  const auto byte = [](uint32_t bits) {
    return std::string(1, static_cast<char>(static_cast<unsigned char>(bits)));
  };
  const auto next = [&](int shift) {
    return byte(0x80 | ((code >> shift) & 0x3F));
  };
  return code < 0x80    ? byte(code)
         : code < 0x800 ? byte(0xC0 | (code >> 6)) + next(0)
         : code < 0x10000
             ? byte(0xE0 | (code >> 12)) + next(6) + next(0)
             : byte(0xF0 | (code >> 18)) + next(12) + next(6) + next(0);
}

TEST(Printable, LeavesWhatLettersConsistOf) {
  for (const std::string text :
       {"",
        "dense/images/v0.png: no such image; look",
        "Stra\xC3\x9F"
        "e/caf\xC3\xA9.jpg",
        "\xE9\x9B\xAA\xE5\xB1\xB1",  // Holds the byte 9B.
        "\xD7\xA9\xD7\x9C\xD7\x95\xD7\x9D",
        "\xF0\x9F\x93\xB7",
        "~\xC2\xA0\xEF\xBF\xBD"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(Printable, IsOneLineWithoutControlCharacters) {
  EXPECT_EQ(Printable("a\nb\r\nc\td\ve\f"), "a b  c d e ");
  EXPECT_EQ(Printable("v\x1b[2J0.png\x07\x7f"), "v?[2J0.png??");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(Printable("a\xC2\x9B"
                      "2Jb\xC2\x85"
                      "c"),
            "a?2Jb c");
  EXPECT_EQ(Printable("a\xE2\x80\xA8"
                      "b\xE2\x80\xA9"
                      "c"),
            "a b c");
}

TEST(Printable, KeepsTheDirectionOfWriting) {
  EXPECT_EQ(Printable("a\xE2\x80\xAEgnp.exe"), "a?gnp.exe");
  EXPECT_EQ(Printable("\xE2\x80\xAA\xE2\x80\xAC\xE2\x81\xA6\xE2\x81\xA9"),
            "????");
}

TEST(Printable, BytesThatAreNotUtf8) {
  for (const std::string bytes : {"\x9B",
                                  "\xC3",
                                  "\xE2\x80",
                                  "\xF0\x9F\x93",
                                  "\xFF",
                                  "\xFE\xFE",
                                  // Overlong forms of '/', ESC and U+009B.
                                  "\xC0\xAF",
                                  "\xC0\x9B",
                                  "\xC1\x9B",
                                  "\xE0\x80\x9B",
                                  "\xE0\x82\x9B",
                                  "\xF0\x80\x82\x9B",
                                  // A surrogate, and a code beyond all.
                                  "\xED\xA0\x80",
                                  "\xF4\x90\x80\x80",
                                  "\xF5\x80\x80\x80"}) {
    EXPECT_EQ(Printable(bytes + "b"), std::string(bytes.size(), '?') + "b");
    EXPECT_EQ(Printable(bytes), std::string(bytes.size(), '?'));
  }
  // What follows a broken character is not lost with it.
  EXPECT_EQ(Printable("\xE2\xC3\xA9"), "?\xC3\xA9");
  EXPECT_EQ(Printable("\xC3\x1b"), "??");
}

TEST(Printable, EveryCharacterOfUnicode) {
  for (uint32_t code = 0; code <= 0x10FFFF; ++code) {
    if (code >= 0xD800 && code <= 0xDFFF) {
      continue;
    }
    const std::string text = Utf8(code);
    const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
    const bool is_obeyed = is_control || (code >= 0x2028 && code <= 0x202E) ||
                           (code >= 0x2066 && code <= 0x2069);
    const std::string printable = Printable(text);
    if (is_obeyed) {
      ASSERT_TRUE(printable == " " || printable == "?") << code;
    } else {
      ASSERT_EQ(printable, text) << code;
    }
    ASSERT_EQ(HasControlCharacter(text + "a"), is_control) << code;
  }
}

TEST(Printable, OfItselfIsItself) {
  std::string bytes;
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      bytes += static_cast<char>(first);
      bytes += static_cast<char>(second);
      const std::string pair = bytes.substr(bytes.size() - 2);
      EXPECT_EQ(Printable(Printable(pair)), Printable(pair));
    }
  }
  EXPECT_EQ(Printable(Printable(bytes)), Printable(bytes));
}

TEST(HasControlCharacter, OtherEncodingsHaveNone) {
  EXPECT_FALSE(HasControlCharacter(""));
  EXPECT_FALSE(HasControlCharacter("caf\xE9.jpg"));          // Latin-1.
  EXPECT_FALSE(HasControlCharacter("\x8E\xCA\x90^.jpg"));    // Shift JIS.
  EXPECT_TRUE(HasControlCharacter("\xE9\x9B\xAA\xC2\x9B"));  // UTF-8.
  EXPECT_TRUE(HasControlCharacter("caf\xE9\x1b"));
}

TEST(ShellWord, QuotesWhatNeedsIt) {
  EXPECT_EQ(ShellWord("dense/0/a-b_c.d"), "dense/0/a-b_c.d");
  EXPECT_EQ(ShellWord("caf\xC3\xA9"), "caf\xC3\xA9");
  EXPECT_EQ(ShellWord("my scene"), "'my scene'");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("a;rm"), "'a;rm'");
  EXPECT_EQ(ShellWord("$(reboot)"), "'$(reboot)'");
  EXPECT_EQ(ShellWord("it's"), "'it'\\''s'");
}

}  // namespace
}  // namespace tsar
