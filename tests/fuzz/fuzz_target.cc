// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/fuzz/fuzz_target.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include <unistd.h>

namespace tsar {
namespace {

constexpr std::string_view kSeparator = "\n----\n";

// Removed when the program ends by itself.
struct Folder {
  Folder() {
    const std::filesystem::path memory = "/dev/shm";
    const std::filesystem::path parent =
        access(memory.c_str(), W_OK) == 0
            ? memory
            : std::filesystem::temp_directory_path();
    path = parent / ("tsar_fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directories(path);
  }
  ~Folder() {
    std::error_code error;
    std::filesystem::remove_all(path, error);
  }
  std::filesystem::path path;
};

}  // namespace

bool Accepts(const std::function<void()>& function) {
  try {
    function();
    return true;
  } catch (const Error& error) {
    if (std::string_view(error.what()).empty()) {
      std::fprintf(stderr, "an Error without a message\n");
      std::abort();
    }
    return false;
  }
}

const std::filesystem::path& FuzzFolder() {
  static const Folder folder;
  return folder.path;
}

std::filesystem::path PutFile(const std::string& name,
                              std::span<const uint8_t> input) {
  const std::filesystem::path path = FuzzFolder() / name;
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(input.data()),
             static_cast<std::streamsize>(input.size()));
  return path;
}

std::string TakeFile(const std::string& name) {
  std::ifstream file(FuzzFolder() / name, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file),
                     std::istreambuf_iterator<char>());
}

std::span<const uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

std::vector<std::span<const uint8_t>> SplitFiles(
    std::span<const uint8_t> input) {
  std::vector<std::span<const uint8_t>> files;
  auto begin = input.begin();
  for (;;) {
    const auto end = std::search(
        begin,
        input.end(),
        kSeparator.begin(),
        kSeparator.end(),
        [](uint8_t a, char b) { return a == static_cast<uint8_t>(b); });
    files.push_back(input.subspan(static_cast<size_t>(begin - input.begin()),
                                  static_cast<size_t>(end - begin)));
    if (end == input.end()) {
      return files;
    }
    begin = end + static_cast<std::ptrdiff_t>(kSeparator.size());
  }
}

std::string JoinFiles(const std::vector<std::string>& files) {
  std::string joined;
  for (const std::string& file : files) {
    joined += (joined.empty() ? "" : std::string(kSeparator)) + file;
  }
  return joined;
}

}  // namespace tsar
