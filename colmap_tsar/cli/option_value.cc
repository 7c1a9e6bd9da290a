// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_value.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/cli/name_suggestion.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <type_traits>

namespace tsar {
namespace {

template <typename T>
std::string NumberText(T value) {
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, result.ptr);
}

std::string JoinChoices(const std::vector<std::string>& choices,
                        const std::string& separator) {
  std::string joined;
  for (const std::string& choice : choices) {
    joined += (joined.empty() ? "" : separator) + choice;
  }
  return joined;
}

[[noreturn]] void Fail(const std::string& where, const std::string& what) {
  throw Error(ErrorCode::kBadOption, where + ": " + what);
}

bool ParseBool(const std::string& text, const std::string& where) {
  if (text == "1" || text == "true") {
    return true;
  }
  if (text == "0" || text == "false") {
    return false;
  }
  Fail(where, "'" + text + "' is not a switch; give 0 or 1");
}

template <typename T>
T ParseNumber(const std::string& text,
              const OptionRange& range,
              const std::string& where) {
  constexpr bool kIsInteger = std::is_integral_v<T>;
  T value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  bool ok = result.ptr == end && result.ec == std::errc();
  if constexpr (!kIsInteger) {
    ok = ok && std::isfinite(value);
  }
  if (!ok) {
    const bool too_large = result.ec == std::errc::result_out_of_range;
    Fail(where,
         "'" + text + "' is " +
             (too_large    ? "out of range; give a smaller number"
              : kIsInteger ? "not a whole number; give one such as 3"
                           : "not a number; give one such as 0.5"));
  }
  if (static_cast<double>(value) < range.min) {
    Fail(where, text + " is too small; give at least " + NumberText(range.min));
  }
  if (static_cast<double>(value) > range.max) {
    Fail(where, text + " is too large; give at most " + NumberText(range.max));
  }
  return value;
}

std::string ParseText(const std::string& text,
                      const std::vector<std::string>& choices,
                      const std::string& where) {
  if (!choices.empty() &&
      std::find(choices.begin(), choices.end(), text) == choices.end()) {
    Fail(where,
         "'" + text + "' is not known; give one of " +
             JoinChoices(choices, ", "));
  }
  return text;
}

// The setting with this name. where: as for Option::Set.
const Option& FindSetting(const std::vector<Option>& settings,
                          const std::string& name,
                          const std::string& where) {
  std::vector<std::string> names;
  for (const Option& setting : settings) {
    if (setting.name == name) {
      return setting;
    }
    names.push_back(setting.name);
  }
  const std::vector<std::string> similar = SuggestNames(name, names);
  Fail(where,
       "there is no '" + name + "'; " +
           (similar.empty()
                ? ""
                : "did you mean " + JoinChoices(similar, " or ") + "? ") +
           where + " help lists all");
}

void SetSettings(const std::vector<Option>& settings,
                 const std::string& text,
                 const std::string& where) {
  std::istringstream entries(text);
  std::set<std::string> names;
  for (std::string entry; std::getline(entries, entry, ',');) {
    const size_t equals = entry.find('=');
    if (equals == std::string::npos) {
      Fail(where, "'" + entry + "' is not of the form name=value");
    }
    const std::string name = entry.substr(0, equals);
    const Option& setting = FindSetting(settings, name, where);
    if (!names.insert(name).second) {
      Fail(where, name + " is given twice; give it once");
    }
    setting.Set(entry.substr(equals + 1), where + " " + name);
  }
}

}  // namespace

void Option::Set(const std::string& text, const std::string& where) const {
  std::visit(
      [&](auto* value) {
        using T = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<T, bool>) {
          *value = ParseBool(text, where);
        } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
          *value = text;
        } else if constexpr (std::is_same_v<T, std::string>) {
          if (!settings.empty()) {
            SetSettings(settings, text, where);
          }
          *value = ParseText(text, choices, where);
        } else {
          *value = ParseNumber<T>(text, range, where);
        }
      },
      target);
}

std::string Option::Text() const {
  return std::visit(
      [](const auto* value) -> std::string {
        using T = std::remove_cv_t<std::remove_pointer_t<decltype(value)>>;
        if constexpr (std::is_same_v<T, bool>) {
          return *value ? "1" : "0";
        } else if constexpr (std::is_same_v<T, std::string>) {
          return *value;
        } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
          return value->string();
        } else {
          return NumberText(*value);
        }
      },
      target);
}

bool Option::IsPath() const {
  return std::holds_alternative<std::filesystem::path*>(target);
}

std::string Option::ValueHint() const {
  if (!choices.empty()) {
    return JoinChoices(choices, "|");
  }
  if (!settings.empty()) {
    return "NAME=VALUE,...";
  }
  if (std::holds_alternative<bool*>(target)) {
    return "0|1";
  }
  if (std::holds_alternative<std::string*>(target)) {
    return "TEXT";
  }
  if (IsPath()) {
    return "PATH";
  }
  const bool is_integer = std::holds_alternative<int*>(target) ||
                          std::holds_alternative<int64_t*>(target);
  return is_integer ? "INT" : "NUMBER";
}

}  // namespace tsar
