// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

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

  [[nodiscard]] std::string_view rest() const { return rest_; }

  [[noreturn]] void refuse(const std::string& why) const {
    throw ReadError("line " + std::to_string(number) + " " + why);
  }

  std::vector<std::string_view> words;
  std::string_view line;
  std::size_t number = 0;

 private:
  bool take_line() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number;
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

/// For messages: not more than fits on a line, nothing that cannot be printed.
inline std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 40 ? "...'" : "'");
}

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
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end != last) return false;
  if constexpr (std::is_floating_point_v<T>)
    if (error == std::errc::result_out_of_range) value = out_of_range(word);
  return error == std::errc() || std::is_floating_point_v<T>;
}

}  // namespace dapple
