// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_list.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/printable.h"

namespace tsar {
namespace {

// Upper bound of the length of file names.
constexpr size_t kMaxNameLength = 4096;
// The byte order mark that some editors write at the beginning of a text.
constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";

std::string Trimmed(const std::string& text) {
  constexpr const char* kBlank = " \t\r\n\v\f";
  const size_t first = text.find_first_not_of(kBlank);
  return first == std::string::npos
             ? ""
             : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

}  // namespace

std::vector<ListedImage> ReadImageList(const std::filesystem::path& path,
                                       const SparseModel& model,
                                       const std::string& option) {
  InputFile file(path);
  if (!file) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "the list of images is missing or cannot be read (" +
                          file.Reason() + ")",
                      "check " + option);
  }
  std::vector<ListedImage> images;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (number == 1 && line.starts_with(kByteOrderMark)) {
      line.erase(0, 3);
    }
    const std::string name = Trimmed(line);
    if (name.empty()) {
      continue;
    }
    if (name.size() > kMaxNameLength || HasControlCharacter(name)) {
      throw Error::File(ErrorCode::kCorrupt,
                        path.string(),
                        "line " + std::to_string(number) + " is no image name",
                        "give a text file with one image name per line");
    }
    const int image = model.IndexOf(name);
    if (image < 0) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "line " + std::to_string(number) + " names " + name +
                            ", which is not in the sparse model",
                        "correct the line");
    }
    images.push_back({image, number});
  }
  if (images.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the list names no image",
                      "write one image name per line");
  }
  return images;
}

}  // namespace tsar
