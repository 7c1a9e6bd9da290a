// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Feeds the readers of files:
//
//   tsar_fuzz          the seeds of all targets, and all that these begin with
//   tsar_fuzz TARGET FOLDER [libFuzzer's options and files]
//                      writes the target's seeds to the folder and continues
//                      from there; where Clang built the program with TSAR_FUZZ

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "tests/fuzz/fuzz_target.h"
#include <glog/logging.h>

#ifdef TSAR_LIBFUZZER
extern "C" int LLVMFuzzerRunDriver(
    int* argc, char*** argv, int (*read)(const uint8_t* data, size_t size));
#endif

namespace tsar {
namespace {

// The number of readers that accept the input. An Error must have a message for
// the user.
int Read(const FuzzTarget& target, std::span<const uint8_t> input) {
  int num_accepted = 0;
  for (const auto& read : target.readers) {
    try {
      read(input);
      ++num_accepted;
    } catch (const Error& error) {
      if (error.what()[0] == '\0') {
        std::fprintf(stderr, "an Error without a message\n");
        std::abort();
      }
    }
  }
  return num_accepted;
}

std::span<const uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

int ReadSeeds() {
  for (const FuzzTarget& target : MakeFuzzTargets()) {
    for (const std::string& seed : target.seeds) {
      if (Read(target, BytesOf(seed)) == 0) {
        std::cerr << target.name << ": a seed is refused\n";
        return 1;
      }
      // Up to a size for which that takes no time.
      for (size_t size = 0; size < std::min<size_t>(seed.size(), 512); ++size) {
        const std::string cut = seed.substr(0, size);
        Read(target, BytesOf(cut));
      }
    }
  }
  return 0;
}

#ifdef TSAR_LIBFUZZER
FuzzTarget current_target;

int Fuzz(int argc, char** argv) {
  for (const FuzzTarget& target : MakeFuzzTargets()) {
    if (target.name == argv[1]) {
      current_target = target;
    }
  }
  const std::filesystem::path folder = argv[2];
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : current_target.seeds) {
    std::ofstream(folder / ("seed_" + std::to_string(number++)),
                  std::ios::binary)
        << seed;
  }
  argv[1] = argv[0];
  --argc;
  ++argv;
  return LLVMFuzzerRunDriver(
      &argc, &argv, [](const uint8_t* data, size_t size) {
        Read(current_target, {data, size});
        return 0;
      });
}
#endif

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  // Warnings are for users; they would be millions of lines.
  FLAGS_minloglevel = google::GLOG_ERROR;
#ifdef TSAR_LIBFUZZER
  if (argc > 2) {
    return tsar::Fuzz(argc, argv);
  }
#endif
  if (argc > 1) {
    std::cerr << argv[0] << ": built without libFuzzer; use the preset fuzz\n";
    return 1;
  }
  return tsar::ReadSeeds();
}
