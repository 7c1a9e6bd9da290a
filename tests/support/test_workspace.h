// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {

// A folder that exists as long as the test.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void WriteText(const std::filesystem::path& path, const std::string& text);
std::string ReadText(const std::filesystem::path& path);

// Appends the bytes of a value.
template <typename T>
void Append(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// A dense workspace of three images of 8 x 6 pixels, "a.png", "left/b.png" and
// "c.png", with maps of both types of 4 x 3 pixels whose depths differ.
void MakeTestWorkspace(const std::filesystem::path& root);

// Gives one map other depths, as a new run of patch_match_stereo would.
void WriteTestMaps(const std::filesystem::path& root,
                   const std::string& image,
                   MapType type,
                   float depth);

// Maps of 4 x 3 pixels.
RefinedMaps MakeRefinedMaps(float depth, int width = 4, int height = 3);

// Expects that a function throws an Error of this code whose message is one
// line and contains all the texts.
void ExpectError(ErrorCode code,
                 const std::vector<std::string>& texts,
                 const std::function<void()>& function);

}  // namespace tsar
