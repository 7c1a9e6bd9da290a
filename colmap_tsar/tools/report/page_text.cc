// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/page_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>

namespace tsar {
namespace {

constexpr size_t kMaxNameLength = 50;

bool IsPlain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
         (c >= 'a' && c <= 'z') || c == '-' || c == '.';
}

}  // namespace

void ReplaceAll(std::string_view from, std::string_view to, std::string* text) {
  for (size_t at = text->find(from); at != std::string::npos;
       at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

std::string EscapeHtml(const std::string& text) {
  std::string escaped = text;
  ReplaceAll("&", "&amp;", &escaped);  // "&" first, since the others add it.
  ReplaceAll("<", "&lt;", &escaped);
  ReplaceAll(">", "&gt;", &escaped);
  ReplaceAll("\"", "&quot;", &escaped);
  ReplaceAll("'", "&#39;", &escaped);
  return escaped;
}

std::string EscapeScript(const std::string& json) {
  std::string escaped = json;
  ReplaceAll("<", "\\u003c", &escaped);
  ReplaceAll("\xE2\x80\xA8", "\\u2028", &escaped);
  ReplaceAll("\xE2\x80\xA9", "\\u2029", &escaped);
  return escaped;
}

std::string SafeFileName(int index, const std::string& image_name) {
  std::string plain = image_name.substr(0, kMaxNameLength);
  std::ranges::replace_if(
      plain, [](char c) { return !IsPlain(c); }, '_');
  // A trailing dot, or two dots, are special in some file systems.
  ReplaceAll("..", "_", &plain);
  char number[16];
  std::snprintf(number, sizeof(number), "%05d_", index);
  return number + plain + (plain.ends_with('.') ? "_" : "");
}

}  // namespace tsar
