// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Feeds one reader:
//
//   tsar_fuzz list                         names all targets
//   tsar_fuzz seeds TARGET FOLDER          writes the inputs to begin with
//   tsar_fuzz replay TARGET PATH...        reads files, or all files of folders
//   tsar_fuzz fuzz TARGET [libFuzzer's options and folders]
//
// The last one is there where Clang built the program with TSAR_FUZZ; replaying
// is there with every compiler.

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>

#include "tests/fuzz/fuzz_target.h"
#include <glog/logging.h>

#ifdef TSAR_LIBFUZZER
extern "C" int LLVMFuzzerRunDriver(
    int* argc, char*** argv, int (*read)(const uint8_t* data, size_t size));
#endif

namespace tsar {
namespace {

constexpr const FuzzTarget* kTargets[] = {&kMapTarget,
                                          &kSigmaMapTarget,
                                          &kSparseBinaryTarget,
                                          &kSparseTextTarget,
                                          &kConfigTarget,
                                          &kImageListTarget,
                                          &kProjectIniTarget,
                                          &kRecordTarget,
                                          &kDmbTarget,
                                          &kApdTarget,
                                          &kDmapTarget,
                                          &kStoredCameraTarget,
                                          &kNpyTarget,
                                          &kPfmTarget,
                                          &kPlyTarget,
                                          &kMeshlabTarget};

const FuzzTarget* current_target = nullptr;

int ReadInput(const uint8_t* data, size_t size) {
  current_target->read({data, size});
  return 0;
}

int List() {
  for (const FuzzTarget* target : kTargets) {
    std::cout << target->name << "\n";
  }
  return 0;
}

int WriteSeeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : current_target->make_seeds()) {
    std::ofstream(folder / ("seed_" + std::to_string(number++)),
                  std::ios::binary)
        << seed;
  }
  std::cout << number << " seeds\n";
  return 0;
}

void Replay(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string input{std::istreambuf_iterator<char>(file),
                          std::istreambuf_iterator<char>()};
  ReadInput(BytesOf(input).data(), input.size());
  // Also all that is shorter, up to a size where that takes no time.
  for (size_t size = 0; size < std::min<size_t>(input.size(), 512); ++size) {
    const std::string cut = input.substr(0, size);
    ReadInput(BytesOf(cut).data(), size);
  }
}

int ReplayAll(int num_paths, char** paths) {
  int num_files = 0;
  for (int i = 0; i < num_paths; ++i) {
    if (!std::filesystem::is_directory(paths[i])) {
      Replay(paths[i]);
      ++num_files;
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(paths[i])) {
      Replay(entry.path());
      ++num_files;
    }
  }
  std::cout << num_files << " files\n";
  return num_files > 0 ? 0 : 1;
}

int Fuzz(int argc, char** argv) {
#ifdef TSAR_LIBFUZZER
  return LLVMFuzzerRunDriver(&argc, &argv, &ReadInput);
#else
  std::cerr << argv[0] << " " << argc
            << ": built without libFuzzer; use the preset fuzz\n";
  return 1;
#endif
}

int Main(int argc, char** argv) {
  const std::string action = argc > 1 ? argv[1] : "";
  if (action == "list") {
    return List();
  }
  if (argc > 2) {
    const auto target = std::find_if(
        std::begin(kTargets), std::end(kTargets), [&](const auto* known) {
          return std::strcmp(known->name, argv[2]) == 0;
        });
    current_target = target == std::end(kTargets) ? nullptr : *target;
  }
  if (current_target != nullptr && action == "fuzz") {
    argv[2] = argv[0];
    return Fuzz(argc - 2, argv + 2);
  }
  if (current_target != nullptr && argc > 3 && action == "seeds") {
    return WriteSeeds(argv[3]);
  }
  if (current_target != nullptr && argc > 3 && action == "replay") {
    return ReplayAll(argc - 3, argv + 3);
  }
  std::cerr << "usage: tsar_fuzz list | seeds TARGET FOLDER | replay TARGET "
               "PATH... | fuzz TARGET [OPTION...]\n";
  return 1;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  // Warnings are for users; they would be millions of lines.
  FLAGS_minloglevel = google::GLOG_ERROR;
  return tsar::Main(argc, argv);
}
