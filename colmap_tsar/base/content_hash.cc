// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/content_hash.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/text_stream.h"

#include <cinttypes>
#include <new>
#include <vector>

namespace tsar {

ContentHash::ContentHash() : state_(XXH3_createState(), &XXH3_freeState) {
  if (!state_) {
    throw std::bad_alloc();
  }
  XXH3_64bits_reset(state_.get());
}

void ContentHash::Update(const void* data, size_t num_bytes) {
  // An empty array may have a null address, which some versions reject.
  if (num_bytes > 0) {
    XXH3_64bits_update(state_.get(), data, num_bytes);
  }
}

uint64_t ContentHash::Value() const { return XXH3_64bits_digest(state_.get()); }

uint64_t HashFile(const std::filesystem::path& path) {
  InputFile file(path);
  file.RequireOpened("file", "check that it exists");
  ContentHash hash;
  std::vector<char> buffer(size_t{1} << 20);
  while (file) {
    file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hash.Update(buffer.data(), static_cast<size_t>(file.gcount()));
  }
  return hash.Value();
}

std::string HexDigits(uint64_t hash) { return Formatted("%016" PRIx64, hash); }

uint32_t HashImageName(const std::string& name) {
  uint32_t hash = 2166136261u;
  for (const char character : name) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 16777619u;
  }
  return hash;
}

}  // namespace tsar
