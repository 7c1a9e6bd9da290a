// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <new>
#include <string>
#include <vector>

#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/stat.h>

namespace tsar {
namespace {

std::string ReadAll(std::istream& stream) {
  return std::string(std::istreambuf_iterator<char>(stream),
                     std::istreambuf_iterator<char>());
}

class InputFileTest : public testing::Test {
 protected:
  void ExpectRefused(const std::filesystem::path& path,
                     const std::string& reason) {
    SCOPED_TRACE(path);
    InputFile file(path);
    EXPECT_FALSE(file);
    EXPECT_NE(file.Reason().find(reason), std::string::npos) << file.Reason();
    EXPECT_EQ(file.get(), InputFile::traits_type::eof());
    // Like parsers that ignore the stream's state.
    ASSERT_TRUE(file.rdbuf());
    EXPECT_EQ(file.rdbuf()->sgetc(), InputFile::traits_type::eof());
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "file";
};

TEST_F(InputFileTest, ReadsAsStreamsDo) {
  WriteText(path_, "first\nsecond\n");
  InputFile file(path_);
  EXPECT_EQ(file.Size(), 13u);
  EXPECT_EQ(file.Reason(), "");
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  EXPECT_EQ(line, "first");
  file.seekg(1);
  char text[4];
  ASSERT_TRUE(file.read(text, 4));
  EXPECT_EQ(std::string(text, 4), "irst");
  file.seekg(2, std::ios::cur);
  EXPECT_EQ(ReadAll(file), "econd\n");
}

// Opening a FIFO for reading blocks until there is a writer.
TEST_F(InputFileTest, WaitsForNoFifoAndReadsNoDevice) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  ExpectRefused(path_, "FIFO");
  ExpectRefused("/dev/zero", "device");
  ExpectRefused(folder_.Path(), "folder");
  ExpectRefused(folder_.Path() / "missing", "No such file");
  ExpectRefused(path_ / "below", "Not a directory");
  std::filesystem::create_symlink("/dev/zero", folder_.Path() / "link");
  ExpectRefused(folder_.Path() / "link", "device");
}

// Nothing is mapped at the first address of a process, so reading there fails.
TEST_F(InputFileTest, ADiskThatFailsIsNotTheEndOfTheFile) {
  const auto expect_error = [](const auto& read) {
    InputFile file("/proc/self/mem");
    ASSERT_TRUE(file) << file.Reason();
    try {
      read(file);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), ErrorCode::kIo);
      EXPECT_EQ(
          std::string(error.what()).find("/proc/self/mem: cannot be read"), 0u)
          << error.what();
    }
  };
  expect_error([](InputFile& file) { ReadAll(file); });
  expect_error([](InputFile& file) {
    std::string line;
    std::getline(file, line);
  });
  expect_error([](InputFile& file) {
    std::string large(size_t{1} << 20, ' ');
    file.read(large.data(), static_cast<std::streamsize>(large.size()));
  });
}

// OpenCV reports that an encoder had no memory as an assertion of its own. More
// rows than JPEG can have fail in the encoder in the same way.
TEST(PutPicture, TellsAFormatThatIsMissingFromAnEncoderWithoutMemory) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "picture";
  AtomicFile file(UserPath(path));
  const cv::Mat pixels = cv::Mat_<uint8_t>(70000, 1, uint8_t{7});
  ExpectError(ErrorCode::kIo, {path.string(), "encoded as abc"}, [&] {
    PutPicture(pixels, ".abc", path, &file);
  });
  EXPECT_THROW(PutPicture(pixels, ".jpg", path, &file), std::bad_alloc);
}

// The fingerprints of all workspaces depend on it.
TEST(ContentHashTest, IsXxh3WhateverTheSplit) {
  EXPECT_EQ(ContentHash().Value(), 0x2D06800538D394C2u);
  std::string bytes;
  for (int i = 0; i < 200; ++i) {
    bytes.push_back(static_cast<char>(i * 7));
  }
  ContentHash whole;
  whole.Update(bytes.data(), bytes.size());
  for (const size_t step : {1u, 3u, 31u, 32u, 33u, 100u}) {
    ContentHash parts;
    for (size_t i = 0; i < bytes.size(); i += step) {
      parts.Update(nullptr, 0);
      parts.Update(bytes.data() + i, std::min(step, bytes.size() - i));
    }
    EXPECT_EQ(parts.Value(), whole.Value()) << step;
  }
}

TEST(AdviceForMissing, NamesTheFileThatDiffersInCaseAlone) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "b.JPG.bin", "");
  EXPECT_EQ(AdviceForMissing(folder.Path() / "a.jpg.bin", "make it"),
            "make it");
  EXPECT_THAT(AdviceForMissing(folder.Path() / "b.jpg.bin", "make it"),
              testing::HasSubstr("there is b.JPG.bin, which differs in upper "
                                 "and lower case: rename"));
  EXPECT_EQ(AdviceForMissing(folder.Path() / "none/b.jpg.bin", "make it"),
            "make it");
}

}  // namespace
}  // namespace tsar
