// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifndef _WIN32
#include <locale.h>  // newlocale and strtod_l are of no C++ header
#endif
#ifdef __APPLE__
#include <xlocale.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.hpp"

namespace dapple {

/// What is wrong with a file, and where; without its name.
class ReadError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The lines of a text, cut into words, with their numbers.
class Lines {
 public:
  /// \param comment what follows it on a line is left out; 0: nothing does
  explicit Lines(std::string_view text, char comment = 0) : rest_(text), comment_(comment) {}

  /// The next line that holds a word; false at the end.
  bool next() {
    words.clear();
    while (words.empty() && take_line()) split();
    return !words.empty();
  }

  /// The line behind this one, which may hold no word; false at the end.
  bool next_line() {
    words.clear();
    if (!take_line()) return false;
    split();
    return true;
  }

  [[nodiscard]] std::string_view rest() const { return rest_; }

  [[noreturn]] void refuse(const std::string& why) const {
    throw ReadError("line " + std::to_string(number) + " " + why);
  }

  /// The number in a word; `what` names it in errors.
  /// \throw ReadError naming the line
  template <typename T>
  [[nodiscard]] T number_in(std::string_view word, const char* what) const;

  /// Numbers from the word `first` on.
  /// \throw ReadError naming the line
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(std::size_t first, const char* what) const;

  std::vector<std::string_view> words;
  std::string_view line;
  std::size_t number = 0;

 private:
  bool take_line() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    check_at(++number);
    return true;
  }

  void split() {
    words.clear();
    std::string_view left = comment_ == 0 ? line : line.substr(0, line.find(comment_));
    while (true) {
      left.remove_prefix(std::min(left.find_first_not_of(kBlanks), left.size()));
      if (left.empty()) return;
      const std::size_t end = std::min(left.find_first_of(kBlanks), left.size());
      words.push_back(left.substr(0, end));
      left.remove_prefix(end);
    }
  }

  static constexpr const char* kBlanks = " \t\r\f\v";
  std::string_view rest_;
  char comment_;
};

/// For messages: shortened to fit a line, without unprintable characters.
inline std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 40 ? "...'" : "'");
}

#ifndef _WIN32
/// What std::from_chars does, without it: by the C library, in its own language.
inline std::from_chars_result parse_by_locale(const char* first, const char* last, double& value) {
  static const locale_t kPlain = newlocale(LC_ALL_MASK, "C", nullptr);
  if (first != last && *first == '+') return {first, std::errc::invalid_argument};
  const auto hexadecimal = [](char c) { return c == 'x' || c == 'X'; };
  const std::string word(first, std::find_if(first, last, hexadecimal));
  char* end = nullptr;
  errno = 0;
  const double found = strtod_l(word.c_str(), &end, kPlain);
  if (end == word.c_str()) return {first, std::errc::invalid_argument};
  const bool outside = errno == ERANGE && (found == 0.0 || std::isinf(found));
  if (!outside) value = found;
  return {first + (end - word.c_str()), outside ? std::errc::result_out_of_range : std::errc()};
}
#endif

template <typename T>
std::from_chars_result parse_start(const char* first, const char* last, T& value) {
  return std::from_chars(first, last, value);
}
// LLVM's library reads floating-point numbers since version 20, on macOS since macOS 26.
#if defined(_LIBCPP_VERSION) && !defined(_WIN32)
#if _LIBCPP_VERSION < 200000 || !_LIBCPP_AVAILABILITY_HAS_FROM_CHARS_FLOATING_POINT
inline std::from_chars_result parse_start(const char* first, const char* last, double& value) {
  return parse_by_locale(first, last, value);
}
#endif
#endif

/// What std::from_chars calls out of range: 0 where it is too small for a double, else infinite.
[[nodiscard]] inline double out_of_range(std::string_view word) {
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos ||
                    word.substr(word[0] == '-' ? 1 : 0).substr(0, 2) == "0.";
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

/// The whole word as a number, whatever the language of the system; false if it is none.
template <typename T>
[[nodiscard]] bool parse(std::string_view word, T& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* last = word.data() + word.size();
  const auto [end, error] = parse_start(word.data(), last, value);
  if (end != last) return false;
  if constexpr (std::is_floating_point_v<T>)
    if (error == std::errc::result_out_of_range) value = out_of_range(word);
  return error == std::errc() || std::is_floating_point_v<T>;
}

template <typename T>
T Lines::number_in(std::string_view word, const char* what) const {
  T value{};
  if (!parse(word, value)) refuse("has " + quoted(word) + " for " + what);
  return value;
}

template <std::size_t N>
std::array<double, N> Lines::numbers(std::size_t first, const char* what) const {
  if (words.size() < first + N) refuse("has fewer than " + std::to_string(N) + " " + what + "s");
  std::array<double, N> values{};
  for (std::size_t k = 0; k < N; ++k)
    values[k] = number_in<double>(words[first + k], (std::string("a ") + what).c_str());
  return values;
}

/// Whether two words are equal except for capital letters; `small` has none.
[[nodiscard]] inline bool same_word(std::string_view word, std::string_view small) {
  return std::equal(word.begin(), word.end(), small.begin(), small.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

/// A text normalized: UTF-16 becomes UTF-8, a byte order mark is removed, and lines that end with a
/// carriage return alone end with a line feed.
class PlainText {
 public:
  explicit PlainText(std::string_view bytes);
  PlainText(const PlainText&) = delete;
  PlainText& operator=(const PlainText&) = delete;
  ~PlainText() = default;

  [[nodiscard]] std::string_view view() const { return view_; }

 private:
  std::string changed_;
  std::string_view view_;
};

/// Without the byte order mark of UTF-8.
[[nodiscard]] std::string_view without_mark(std::string_view bytes);

/// The same with line feeds instead of carriage returns that no line feed follows.
[[nodiscard]] std::string with_line_feeds(std::string_view text);

}  // namespace dapple
