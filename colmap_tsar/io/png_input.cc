// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/png_input.h"

#include "colmap_tsar/io/photo_format.h"

#include <optional>

namespace tsar {

PngInput::PngInput(const std::filesystem::path& path, const PngWords& words)
    : words_(words), file_(path, {words.noun, words.advice, words.advice}) {}

PngHeader PngInput::ReadHeader() {
  const std::vector<uint8_t> head = file_.ReadHead(kPngHeadSize);
  const std::optional<PngHeader> header = ReadPngHeader(head);
  if (header) {
    return *header;
  }
  if (FormatOf(head) == PhotoFormat::kPng) {
    throw Damaged("its header is not whole");
  }
  throw Error::File(ErrorCode::kCorrupt, Name(), words_.no_png, words_.advice);
}

bool PngInput::EndsAsWhole() {
  constexpr uint64_t kTailBytes = 16;
  return EndsInMarker(PhotoFormat::kPng, file_.ReadTail(kTailBytes));
}

Error PngInput::Damaged(const std::string& how) const {
  return Error::File(
      ErrorCode::kCorrupt, Name(), words_.damaged + how, "write it again");
}

}  // namespace tsar
