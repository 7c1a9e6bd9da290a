// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// One reader to be fed with hostile input.
struct FuzzTarget {
  const char* name;
  // Reads the input; nothing but tsar::Error may leave the reader.
  void (*read)(std::span<const uint8_t> input);
  // Inputs that the reader accepts, mostly from the project's own writers.
  std::vector<std::string> (*make_seeds)();
};

extern const FuzzTarget kMapTarget;
extern const FuzzTarget kSigmaMapTarget;
extern const FuzzTarget kSparseBinaryTarget;
extern const FuzzTarget kSparseTextTarget;
extern const FuzzTarget kConfigTarget;
extern const FuzzTarget kImageListTarget;
extern const FuzzTarget kProjectIniTarget;
extern const FuzzTarget kRecordTarget;
extern const FuzzTarget kDmbTarget;
extern const FuzzTarget kApdTarget;
extern const FuzzTarget kDmapTarget;
extern const FuzzTarget kStoredCameraTarget;
extern const FuzzTarget kNpyTarget;
extern const FuzzTarget kPfmTarget;
extern const FuzzTarget kPlyTarget;
extern const FuzzTarget kMeshlabTarget;

// Calls the function; whether it came to its end. An Error must be one that a
// user can make use of: it ends the test otherwise.
bool Accepts(const std::function<void()>& function);

// A folder for the files of one process, in memory where that can be.
const std::filesystem::path& FuzzFolder();

// Writes the input to a file of the folder and returns its path.
std::filesystem::path PutFile(const std::string& name,
                              std::span<const uint8_t> input);
// The content of a file of the folder that a writer of the project wrote.
std::string TakeFile(const std::string& name);

// The bytes of a text, and a value appended as the bytes that it has here.
std::span<const uint8_t> BytesOf(const std::string& text);
template <typename T>
void AppendValue(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// Several files in one input, separated by lines of "----".
std::vector<std::span<const uint8_t>> SplitFiles(
    std::span<const uint8_t> input);
std::string JoinFiles(const std::vector<std::string>& files);

}  // namespace tsar
