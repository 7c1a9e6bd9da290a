// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/state_file.h"

#include "colmap_tsar/base/atomic_file.h"

#include <algorithm>
#include <bit>

namespace tsar {
namespace {

// All data is copied between memory and file as it is.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(int) == 4 && sizeof(float) == 4 && sizeof(double) == 8);

struct Header {
  std::array<char, 8> magic = {};
  uint32_t version = 0;
  uint32_t key_length = 0;
  uint64_t file_size = 0;
  uint64_t checksum = 0;  // Of the fields above and the key.
};
static_assert(sizeof(Header) == 32 && sizeof(StateFileArray) == 16);

uint64_t ChecksumOf(const Header& header, const std::string& key) {
  ContentHash hash;
  hash.Update(&header, offsetof(Header, checksum));
  hash.Update(key.data(), key.size());
  return hash.Value();
}

}  // namespace

void StateFileWriter::Write(const ContainedPath& path,
                            const StateFileKind& kind,
                            const std::string& key) const {
  Header header = {kind.magic,
                   kind.version,
                   static_cast<uint32_t>(key.size()),
                   sizeof(Header) + key.size()};
  for (const Entry& entry : arrays_) {
    header.file_size += sizeof(StateFileArray) + entry.bytes.size() +
                        (entry.ends_part ? sizeof(uint64_t) : 0);
  }
  header.checksum = ChecksumOf(header, key);
  CreateFolders(path.Parent());
  AtomicFile file(path);
  const auto put = [&file](const void* data, size_t num_bytes) {
    file.Stream().write(static_cast<const char*>(data),
                        static_cast<std::streamsize>(num_bytes));
  };
  put(&header, sizeof(header));
  put(key.data(), key.size());
  std::optional<ContentHash> hash;
  for (const Entry& entry : arrays_) {
    if (!hash) {
      hash.emplace();
    }
    hash->Update(&entry.array, sizeof(entry.array));
    put(&entry.array, sizeof(entry.array));
    if (!entry.bytes.empty()) {
      hash->Update(entry.bytes.data(), entry.bytes.size());
      put(entry.bytes.data(), entry.bytes.size());
    }
    if (entry.ends_part) {
      const uint64_t checksum = hash->Value();
      put(&checksum, sizeof(checksum));
      hash.reset();
    }
  }
  file.Commit();
}

StateFileReader::StateFileReader(const std::filesystem::path& path,
                                 const StateFileKind& kind)
    : path_(path), kind_(kind), file_(path) {
  if (file_.IsMissing()) {
    throw Error::File(ErrorCode::kNotFound,
                      path_.string(),
                      kind_.missing,
                      kind_.advice_for_missing);
  }
  if (file_.IsNoFile()) {
    throw Corrupt(file_.Reason());
  }
  if (!file_) {
    throw Error::File(ErrorCode::kIo,
                      path_.string(),
                      "the file cannot be opened (" + file_.Reason() + ")",
                      "check that you may read it");
  }
  ReadHeader();
  hash_.emplace();
}

void StateFileReader::ReadHeader() {
  Header header;
  ReadBytes(std::as_writable_bytes(std::span(&header, 1)));
  if (header.magic != kind_.magic) {
    throw Corrupt("it is another kind of file");
  }
  if (header.version != kind_.version) {
    throw Corrupt("its format is of version " + std::to_string(header.version) +
                  ", this program reads version " +
                  std::to_string(kind_.version));
  }
  if (header.file_size != file_.Size() || header.key_length > file_.Size()) {
    throw Corrupt("it is not complete");
  }
  key_.resize(header.key_length);
  ReadBytes(std::as_writable_bytes(std::span(key_)));
  if (ChecksumOf(header, key_) != header.checksum) {
    throw Corrupt("its header was changed");
  }
}

Error StateFileReader::Corrupt(const std::string& what) const {
  return Error::File(ErrorCode::kCorrupt,
                     path_.string(),
                     std::string("not a usable ") + kind_.name + ": " + what,
                     "delete it and run tsar_refine again");
}

uint64_t StateFileReader::EndPart() {
  const uint64_t checksum = hash_->Value();
  uint64_t expected = 0;
  ReadBytes(std::as_writable_bytes(std::span(&expected, 1)));
  if (checksum != expected) {
    throw Corrupt("its content was changed");
  }
  hash_.emplace();
  return checksum;
}

StateFileArray StateFileReader::ReadArray(size_t element_size) {
  StateFileArray array;
  ReadBytes(std::as_writable_bytes(std::span(&array, 1)));
  if (array.element_size != element_size || array.width < 0 ||
      array.num_elements > file_.Size() / element_size ||
      (array.width > 0 &&
       (array.num_elements % array.width != 0 ||
        array.num_elements > static_cast<uint64_t>(INT32_MAX)))) {
    throw Corrupt("its content was changed");
  }
  return array;
}

void StateFileReader::ReadBytes(std::span<std::byte> bytes) {
  // Pieces are small enough to be hashed in the processor's cache.
  constexpr size_t kPiece = size_t{1} << 18;
  for (size_t begin = 0; begin < bytes.size(); begin += kPiece) {
    const auto piece =
        bytes.subspan(begin, std::min(kPiece, bytes.size() - begin));
    file_.read(reinterpret_cast<char*>(piece.data()),
               static_cast<std::streamsize>(piece.size()));
    if (!file_) {
      throw Corrupt("it is not complete");
    }
    if (hash_) {
      hash_->Update(piece.data(), piece.size());
    }
  }
}

std::optional<std::string> ReadStateFileKey(const std::filesystem::path& path,
                                            const StateFileKind& kind) {
  try {
    return StateFileReader(path, kind).Key();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace tsar
