// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_text.hpp"

#include <optional>

namespace dapple {
namespace {

constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

enum class Wide { kLittle, kBig };

/// Detects UTF-16 by its byte order mark, or by an ASCII character at the beginning.
std::optional<Wide> wide(std::string_view bytes) {
  if (bytes.size() < 2) return std::nullopt;
  const std::string_view start = bytes.substr(0, 2);
  if (start == "\xff\xfe" || (start[0] > 0 && start[1] == 0)) return Wide::kLittle;
  if (start == "\xfe\xff" || (start[0] == 0 && start[1] > 0)) return Wide::kBig;
  return std::nullopt;
}

void add_utf8(std::string& text, std::uint32_t code) {
  const auto byte = [&](std::uint32_t bits) { text += static_cast<char>(bits); };
  if (code < 0x80) return byte(code);
  if (code < 0x800) return byte(0xc0 | code >> 6), byte(0x80 | (code & 0x3f));
  if (code < 0x10000)
    return byte(0xe0 | code >> 12), byte(0x80 | (code >> 6 & 0x3f)), byte(0x80 | (code & 0x3f));
  byte(0xf0 | code >> 18), byte(0x80 | (code >> 12 & 0x3f));
  byte(0x80 | (code >> 6 & 0x3f)), byte(0x80 | (code & 0x3f));
}

std::string narrow(std::string_view bytes, Wide kind) {
  const auto unit = [&](std::size_t k) {
    const auto a = static_cast<unsigned char>(bytes[k]);
    const auto b = static_cast<unsigned char>(bytes[k + 1]);
    return static_cast<std::uint32_t>(kind == Wide::kLittle ? a | b << 8 : b | a << 8);
  };
  std::string text;
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
    std::uint32_t code = unit(k);
    const bool high = code >= 0xd800 && code < 0xdc00 && k + 3 < bytes.size();
    if (high && unit(k + 2) >= 0xdc00 && unit(k + 2) < 0xe000) {
      code = 0x10000 + ((code - 0xd800) << 10) + (unit(k + 2) - 0xdc00);
      k += 2;
    }
    add_utf8(text, code);
  }
  return text;
}

bool has_bare_return(std::string_view text) {
  for (std::size_t k = text.find('\r'); k != text.npos; k = text.find('\r', k + 1))
    if (k + 1 == text.size() || text[k + 1] != '\n') return true;
  return false;
}

}  // namespace

std::string_view without_mark(std::string_view bytes) {
  if (bytes.substr(0, kUtf8Mark.size()) == kUtf8Mark) bytes.remove_prefix(kUtf8Mark.size());
  return bytes;
}

std::string with_line_feeds(std::string_view text) {
  std::string changed(text);
  for (std::size_t k = 0; k < changed.size(); ++k)
    if (changed[k] == '\r' && (k + 1 == changed.size() || changed[k + 1] != '\n'))
      changed[k] = '\n';
  return changed;
}

PlainText::PlainText(std::string_view bytes) : view_(bytes) {
  if (const auto kind = wide(bytes)) view_ = changed_ = narrow(bytes, *kind);
  view_ = without_mark(view_);
  if (has_bare_return(view_)) view_ = changed_ = with_line_feeds(view_);
}

}  // namespace dapple
