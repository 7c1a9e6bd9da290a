// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/state_file.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace tsar {
namespace {

// All data is copied between memory and file as it is.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(int) == 4 && sizeof(float) == 4 && sizeof(double) == 8);
static_assert(sizeof(StateFileStart) == 16);

// A fingerprint of the header before its fingerprint, and of the options hash.
uint64_t FingerprintOfHeader(std::span<const std::byte> header,
                             const std::string& options_hash) {
  ContentHash hash;
  hash.Update(header.data(), header.size() - sizeof(uint64_t));
  hash.Update(options_hash.data(), options_hash.size());
  return hash.Value();
}

}  // namespace

uint64_t FingerprintOfArrays(const ReadableArrays& arrays) {
  ContentHash hash;
  for (const std::span<const std::byte> array : arrays) {
    if (!array.empty()) {
      hash.Update(array.data(), array.size());
    }
  }
  return hash.Value();
}

void RequireNoFault(const ContainedPath& path,
                    const std::optional<std::string>& fault) {
  if (fault) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "what is to be written has " + *fault,
                      "this is a mistake of the program, please report it");
  }
}

StateFileBytesReader::StateFileBytesReader(const std::filesystem::path& path,
                                           const StateFileKind& kind,
                                           std::span<std::byte> header)
    : path_(path), kind_(kind), file_(path), header_size_(header.size()) {
  if (file_.IsMissing()) {
    throw kind_.missing(path_);
  }
  if (file_.IsNoFile()) {
    throw kind_.corrupt(path_, file_.Reason());
  }
  if (!file_) {
    throw Error::File(ErrorCode::kIo,
                      path_.string(),
                      "the file cannot be opened (" + file_.Reason() + ")",
                      "check that you may read it");
  }
  ReadHeader(header);
}

void StateFileBytesReader::ReadHeader(std::span<std::byte> header) {
  // The length of the options hash is not needed yet, and the header of another
  // version may be shorter.
  constexpr size_t kNumFixed = offsetof(StateFileStart, options_hash_length);
  if (file_.Size() < kNumFixed) {
    throw kind_.corrupt(path_, "it is not complete");
  }
  ReadBytes(header.first(kNumFixed));
  StateFileStart start;
  const auto start_bytes = std::as_writable_bytes(std::span(&start, 1));
  std::ranges::copy(header.first(kNumFixed), start_bytes.begin());
  if (start.magic != kind_.magic) {
    throw kind_.corrupt(path_, "it is another kind of file");
  }
  if (start.version != kind_.version) {
    throw kind_.corrupt(
        path_,
        "its format is of version " + std::to_string(start.version) +
            ", this program reads version " + std::to_string(kind_.version));
  }
  if (file_.Size() < header.size()) {
    throw kind_.corrupt(path_, "it is not complete");
  }
  ReadBytes(header.subspan(kNumFixed));
  std::ranges::copy(header.first(sizeof(start)), start_bytes.begin());
  if (start.options_hash_length > file_.Size() - header.size()) {
    throw kind_.corrupt(path_, "its header was changed, or it was cut off");
  }
  options_hash_.resize(start.options_hash_length);
  ReadBytes(std::as_writable_bytes(std::span(options_hash_)));
  uint64_t fingerprint = 0;
  std::memcpy(&fingerprint,
              header.last(sizeof(fingerprint)).data(),
              sizeof(fingerprint));
  if (FingerprintOfHeader(header, options_hash_) != fingerprint) {
    throw kind_.corrupt(path_, "its header was changed");
  }
}

void StateFileBytesReader::RequireLength(
    const std::vector<StateFileArray>& arrays) const {
  // Division, since products of hostile numbers overflow.
  uint64_t rest = file_.Size() - header_size_ - options_hash_.size();
  const bool fit =
      !arrays.empty() && std::ranges::all_of(arrays, [&](StateFileArray array) {
        if (array.num_elements > rest / array.element_size) {
          return false;
        }
        rest -= array.num_elements * array.element_size;
        return true;
      });
  if (!fit || rest != 0) {
    throw kind_.corrupt(path_,
                        "its " + std::to_string(file_.Size()) +
                            " bytes are not what the header says");
  }
}

void StateFileBytesReader::Read(const WritableArrays& arrays,
                                uint64_t fingerprint) {
  // Pieces are small enough to be hashed in the processor's cache.
  constexpr size_t kPiece = size_t{1} << 18;
  ContentHash hash;
  for (const std::span<std::byte> array : arrays) {
    for (size_t begin = 0; begin < array.size(); begin += kPiece) {
      const auto piece =
          array.subspan(begin, std::min(kPiece, array.size() - begin));
      ReadBytes(piece);
      hash.Update(piece.data(), piece.size());
    }
  }
  if (hash.Value() != fingerprint) {
    throw kind_.corrupt(path_, "its content was changed");
  }
}

void StateFileBytesReader::ReadBytes(std::span<std::byte> bytes) {
  file_.read(reinterpret_cast<char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  if (!file_) {
    throw kind_.corrupt(path_, "reading it failed");
  }
}

void WriteStateFileBytes(const ContainedPath& path,
                         std::span<std::byte> header,
                         const std::string& options_hash,
                         const std::vector<ReadableArrays>& parts) {
  const uint64_t fingerprint = FingerprintOfHeader(header, options_hash);
  std::memcpy(header.last(sizeof(fingerprint)).data(),
              &fingerprint,
              sizeof(fingerprint));
  CreateFolders(path.Parent());
  AtomicFile file(path);
  const auto put = [&file](std::span<const std::byte> bytes) {
    file.Stream().write(reinterpret_cast<const char*>(bytes.data()),
                        static_cast<std::streamsize>(bytes.size()));
  };
  put(header);
  put(std::as_bytes(std::span(options_hash)));
  for (const ReadableArrays& arrays : parts) {
    for (const std::span<const std::byte> array : arrays) {
      put(array);
    }
  }
  file.Commit();
}

}  // namespace tsar
