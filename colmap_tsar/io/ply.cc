// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/ply.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/parse_number.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "The readers of binary files copy little-endian numbers.");

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

struct NumberType {
  std::string_view name;
  std::string_view name_with_size;  // In newer files.
  size_t size;
  double (*load)(const char* bytes);
};

constexpr NumberType kNumberTypes[] = {
    {"char", "int8", sizeof(int8_t), &Load<int8_t>},
    {"uchar", "uint8", sizeof(uint8_t), &Load<uint8_t>},
    {"short", "int16", sizeof(int16_t), &Load<int16_t>},
    {"ushort", "uint16", sizeof(uint16_t), &Load<uint16_t>},
    {"int", "int32", sizeof(int32_t), &Load<int32_t>},
    {"uint", "uint32", sizeof(uint32_t), &Load<uint32_t>},
    {"float", "float32", sizeof(float), &Load<float>},
    {"double", "float64", sizeof(double), &Load<double>}};

struct Element {
  std::string name;
  uint64_t count = 0;
  bool has_list = false;
  std::vector<std::string> names;
  std::vector<const NumberType*> types;

  size_t Stride() const {
    size_t stride = 0;
    for (const NumberType* type : types) {
      stride += type->size;
    }
    return stride;
  }
};

class PlyFile {
 public:
  explicit PlyFile(const std::filesystem::path& path) : path_(path.string()) {
    InputFile file(path);
    file.RequireOpened("file", "check the path");
    content_ = file.ReadBytes(0, file.Size());
    rest_ = {reinterpret_cast<const char*>(content_.data()), content_.size()};
    ReadHeader();
  }

  std::vector<Eigen::Vector3d> ReadPoints() {
    for (const Element& element : elements_) {
      if (element.has_list) {
        Fail(ErrorCode::kUnsupported,
             "element " + element.name + " holds a list",
             "save the points without faces or put the vertices first");
      }
      CheckSize(element);
      if (element.name == "vertex") {
        return ReadVertices(element);
      }
      for (uint64_t i = 0; i < element.count; ++i) {
        NextItem(element);
      }
    }
    Corrupt("it has no vertices");
  }

 private:
  [[noreturn]] void Fail(ErrorCode code,
                         const std::string& what,
                         const std::string& advice) const {
    throw Error::File(code, path_, what, advice);
  }
  [[noreturn]] void Corrupt(const std::string& what) const {
    Fail(ErrorCode::kCorrupt, "not a valid PLY file: " + what, "write it anew");
  }

  std::string_view NextLine() {
    const size_t end = rest_.find('\n');
    if (end == std::string_view::npos) {
      Corrupt("its header does not end");
    }
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    return line;
  }

  void ReadHeader() {
    if (NextLine() != "ply") {
      Corrupt("it does not begin with 'ply'");
    }
    bool has_format = false;
    for (std::string_view line = NextLine(); line != "end_header";
         line = NextLine()) {
      std::istringstream words{std::string(line)};
      std::string keyword;
      words >> keyword;
      if (keyword == "format") {
        ReadFormat(&words);
        has_format = true;
      } else if (keyword == "element") {
        Element element;
        if (!(words >> element.name >> element.count)) {
          Corrupt("element without name or count");
        }
        elements_.push_back(element);
      } else if (keyword == "property") {
        ReadProperty(&words);
      } else if (keyword != "comment" && keyword != "obj_info") {
        Corrupt("unknown line '" + std::string(line.substr(0, 40)) +
                "' in its header");
      }
    }
    if (!has_format) {
      Corrupt("its header names no format");
    }
  }

  void ReadFormat(std::istringstream* words) {
    std::string format;
    *words >> format;
    is_ascii_ = format == "ascii";
    if (!is_ascii_ && format != "binary_little_endian") {
      Fail(ErrorCode::kUnsupported,
           "PLY format '" + format.substr(0, 40) + "' cannot be read",
           "save it as ascii or binary_little_endian");
    }
  }

  void ReadProperty(std::istringstream* words) {
    if (elements_.empty()) {
      Corrupt("a property comes before all elements");
    }
    Element& element = elements_.back();
    std::string type_name;
    std::string name;
    *words >> type_name;
    if (type_name == "list") {
      element.has_list = true;
      return;
    }
    const NumberType* type = std::find_if(
        std::begin(kNumberTypes),
        std::end(kNumberTypes),
        [&](const NumberType& known) {
          return type_name == known.name || type_name == known.name_with_size;
        });
    if (!(*words >> name) || type == std::end(kNumberTypes)) {
      Corrupt("a property has no name or an unknown type");
    }
    element.names.push_back(name);
    element.types.push_back(type);
  }

  // Throws if the rest of the file cannot hold the element's items. In ASCII a
  // number takes at least one digit.
  void CheckSize(const Element& element) const {
    const size_t bytes_per_item =
        is_ascii_ ? element.types.size() : element.Stride();
    if (bytes_per_item == 0) {
      if (element.count > 0) {
        Corrupt("element " + element.name + " has no properties");
      }
    } else if (element.count > rest_.size() / bytes_per_item) {
      Corrupt("it is too short for its " + std::to_string(element.count) + " " +
              element.name + " items");
    }
  }

  // The indices of x, y and z among the element's properties.
  std::array<size_t, 3> FindCoordinates(const Element& element) const {
    std::array<size_t, 3> indices;
    for (size_t i = 0; i < 3; ++i) {
      const auto found =
          std::ranges::find(element.names, std::string(1, "xyz"[i]));
      if (found == element.names.end()) {
        Corrupt("its vertices have no x, y, z");
      }
      indices[i] = static_cast<size_t>(found - element.names.begin());
    }
    return indices;
  }

  double NextNumber(const NumberType& type) {
    if (!is_ascii_) {
      const double number = type.load(rest_.data());
      rest_.remove_prefix(type.size);
      return number;
    }
    constexpr std::string_view kBlank = " \t\r\n";
    const size_t begin =
        std::min(rest_.find_first_not_of(kBlank), rest_.size());
    const size_t end =
        std::min(rest_.find_first_of(kBlank, begin), rest_.size());
    const std::optional<double> number =
        ParseNumber<double>(rest_.substr(begin, end - begin));
    if (!number) {
      Corrupt("a number is missing or cannot be read");
    }
    rest_.remove_prefix(end);
    return *number;
  }

  // Reads the values of an item; valid until the next call.
  const std::vector<double>& NextItem(const Element& element) {
    values_.clear();
    for (const NumberType* type : element.types) {
      values_.push_back(NextNumber(*type));
    }
    return values_;
  }

  std::vector<Eigen::Vector3d> ReadVertices(const Element& element) {
    const std::array<size_t, 3> indices = FindCoordinates(element);
    std::vector<Eigen::Vector3d> points(element.count);
    for (size_t i = 0; i < points.size(); ++i) {
      const std::vector<double>& values = NextItem(element);
      points[i] = {values[indices[0]], values[indices[1]], values[indices[2]]};
      if (!points[i].allFinite()) {
        Corrupt("vertex " + std::to_string(i) + " is not finite");
      }
    }
    return points;
  }

  std::string path_;
  std::vector<uint8_t> content_;
  std::string_view rest_;
  bool is_ascii_ = false;
  std::vector<Element> elements_;
  std::vector<double> values_;
};

}  // namespace

std::vector<Eigen::Vector3d> ReadPlyPoints(const std::filesystem::path& path) {
  return PlyFile(path).ReadPoints();
}

}  // namespace tsar
