// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace tsar {

// Binary files in which one pass of a run stores the input of the next ones.
// Little-endian, without padding: a header of fixed size, the options hash,
// arrays. Their headers are structs that begin with a StateFileStart, end with
// a uint64_t header_fingerprint, hold fingerprints of the arrays, and return by
//
//   std::vector<StateFileArray> Arrays() const;
//
// the arrays that follow; none at all where the sizes are impossible.

// The fields that are the same in all versions of all formats.
struct StateFileStart {
  std::array<char, 8> magic = {};
  uint32_t version = 0;
  uint32_t options_hash_length = 0;
};

struct StateFileArray {
  uint64_t num_elements = 0;
  size_t element_size = 0;  // In bytes.
};

// A format of state files, with its errors.
struct StateFileKind {
  std::array<char, 8> magic;
  // To be incremented with every change of the meaning of the bytes, including
  // fingerprints.
  uint32_t version;
  Error (*missing)(const std::filesystem::path& path);
  // what: the fault, such as "its content was changed".
  Error (*corrupt)(const std::filesystem::path& path, const std::string& what);
};

// Arrays in the order of the file.
using ReadableArrays = std::vector<std::span<const std::byte>>;
using WritableArrays = std::vector<std::span<std::byte>>;

// The elements of a vector or an image; writable where the container is.
template <typename Container>
auto BytesOf(Container& container) {
  const std::span elements(container);
  using Element = typename decltype(elements)::element_type;
  static_assert(std::is_trivially_copyable_v<Element>);
  if constexpr (std::is_const_v<Element>) {
    return std::as_bytes(elements);
  } else {
    return std::as_writable_bytes(elements);
  }
}

uint64_t FingerprintOfArrays(const ReadableArrays& arrays);

// Throws kMismatch with the fault of a file's content, if any, before that is
// written.
void RequireNoFault(const ContainedPath& path,
                    const std::optional<std::string>& fault);

// A reader and a writer for headers of unknown layout; use the templates below.
class StateFileBytesReader {
 public:
  StateFileBytesReader(const std::filesystem::path& path,
                       const StateFileKind& kind,
                       std::span<std::byte> header);

  const std::string& OptionsHash() const { return options_hash_; }

  // Throws where the file does not consist of the header, the options hash and
  // these arrays.
  void RequireLength(const std::vector<StateFileArray>& arrays) const;

  // Reads the next arrays of the file, which have their sizes already.
  void Read(const WritableArrays& arrays, uint64_t fingerprint);

 private:
  void ReadHeader(std::span<std::byte> header);
  void ReadBytes(std::span<std::byte> bytes);

  const std::filesystem::path path_;
  const StateFileKind& kind_;
  InputFile file_;
  const size_t header_size_;
  std::string options_hash_;
};

void WriteStateFileBytes(const ContainedPath& path,
                         std::span<std::byte> header,
                         const std::string& options_hash,
                         const std::vector<ReadableArrays>& parts);

template <typename Header>
constexpr void CheckStateFileHeader() {
  static_assert(std::is_trivially_copyable_v<Header>);
  static_assert(offsetof(Header, start) == 0);
  static_assert(offsetof(Header, header_fingerprint) ==
                sizeof(Header) - sizeof(uint64_t));
}

// An open file whose header is intact and agrees with the file's length, so
// that memory may be allocated for its arrays. The constructor throws the
// kind's errors, and kIo where the file may not be read; Read() throws the
// error for a corrupt file.
template <typename Header>
class StateFileReader {
 public:
  // kind must outlive the reader.
  StateFileReader(const std::filesystem::path& path, const StateFileKind& kind)
      : bytes_(path, kind, std::as_writable_bytes(std::span(&header_, 1))) {
    CheckStateFileHeader<Header>();
    bytes_.RequireLength(header_.Arrays());
  }

  const Header& GetHeader() const { return header_; }
  const std::string& OptionsHash() const { return bytes_.OptionsHash(); }

  // Reads the next arrays of the file, which have their sizes already.
  void Read(const WritableArrays& arrays, uint64_t fingerprint) {
    bytes_.Read(arrays, fingerprint);
  }

 private:
  Header header_;
  StateFileBytesReader bytes_;
};

// Writes the file atomically; creates the folder. All fields of the header but
// its start and its own fingerprint are set already.
template <typename Header>
void WriteStateFile(const ContainedPath& path,
                    const StateFileKind& kind,
                    Header header,
                    const std::string& options_hash,
                    const std::vector<ReadableArrays>& parts) {
  CheckStateFileHeader<Header>();
  header.start = {
      kind.magic, kind.version, static_cast<uint32_t>(options_hash.size())};
  WriteStateFileBytes(
      path, std::as_writable_bytes(std::span(&header, 1)), options_hash, parts);
}

// The options hash in a file's header. Nothing where there is no file, or none
// that a reader would open.
template <typename Header>
std::optional<std::string> ReadStateFileHash(const std::filesystem::path& path,
                                             const StateFileKind& kind) {
  try {
    return StateFileReader<Header>(path, kind).OptionsHash();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace tsar
