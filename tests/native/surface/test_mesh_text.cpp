// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/random.hpp"
#include "surface/mesh_text.hpp"

namespace dapple::test {
namespace {

#ifndef _WIN32  // on Windows all libraries read numbers by std::from_chars

/// Compare the number at the start of a word with that of std::from_chars.
void expect_alike(const std::string& word) {
  const char *first = word.data(), *last = first + word.size();
  double expected = 7.0, found = 7.0;
  const auto [end, error] = std::from_chars(first, last, expected);
  const std::from_chars_result result = parse_by_locale(first, last, found);
  EXPECT_EQ(result.ptr - first, end - first) << word;
  EXPECT_EQ(result.ec, error) << word;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found), std::bit_cast<std::uint64_t>(expected)) << word;
}

TEST(MeshText, ReadsWordsAlikeWithoutFromChars) {
  const std::vector<std::string> words = {"",
                                          "0",
                                          "-0",
                                          "1.5",
                                          "-2.5e3",
                                          "1e22",
                                          "1e+5",
                                          ".5",
                                          "5.",
                                          "1,5",
                                          "+1",
                                          "-+1",
                                          "--1",
                                          "e5",
                                          "1e",
                                          "1e+",
                                          "-",
                                          ".",
                                          "0x10",
                                          "0X1p3",
                                          "1.5x",
                                          "inf",
                                          "-inf",
                                          "infinity",
                                          "1e400",
                                          "-1e400",
                                          "1e-400",
                                          "-1e-400",
                                          "4.9e-324",
                                          "2e-324",
                                          "1e-310",
                                          "1.7976931348623157e308",
                                          "1.7976931348623159e308",
                                          "0.1",
                                          "9007199254740993",
                                          "2.2250738585072011e-308",
                                          "7 8",
                                          "abc"};
  for (const std::string& word : words) expect_alike(word);
}

TEST(MeshText, ReadsEveryNumberThatIsWrittenWithoutFromChars) {
  Random random(3);
  for (int round = 0; round < 20000; ++round) {
    const double scale = std::exp2(2000.0 * random.uniform() - 1000.0);
    std::array<char, 32> digits{};
    const double value = scale * (random.uniform() - 0.5);
    char* end = std::to_chars(digits.data(), digits.data() + 32, value).ptr;
    expect_alike(std::string(digits.data(), end));
  }
}

#endif

}  // namespace
}  // namespace dapple::test
