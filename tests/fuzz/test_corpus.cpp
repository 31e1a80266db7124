// SPDX-License-Identifier: GPL-3.0-or-later
// The kept inputs of the fuzzers again, without one: what was found once stays found.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "targets.hpp"

namespace dapple::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

/// Two hexadecimal digits a byte.
Input decoded(const std::string& line) {
  Input input;
  for (std::size_t k = 0; k + 1 < line.size(); k += 2)
    input.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(k, 2), nullptr, 16)));
  return input;
}

/// One a line, but for comments.
std::vector<Input> inputs_of(const Target& target) {
  std::ifstream file(std::string(DAPPLE_FUZZ_CORPUS) + "/" + target.name + ".hex");
  std::vector<Input> inputs;
  for (std::string line; std::getline(file, line);)
    if (!line.starts_with("#")) inputs.push_back(decoded(line));
  return inputs;
}

class FuzzCorpus : public testing::TestWithParam<Target> {};

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpus, testing::ValuesIn(kTargets),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(FuzzCorpus, HoldsNoInputThatBreaksARule) {
  const std::vector<Input> inputs = inputs_of(GetParam());
  ASSERT_FALSE(inputs.empty());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    SCOPED_TRACE("input " + std::to_string(k));
    Bytes bytes(inputs[k]);
    EXPECT_NO_THROW(GetParam().run(bytes));
  }
}

TEST_P(FuzzCorpus, TakesAnEmptyInput) {
  Bytes bytes(std::span<const std::uint8_t>{});
  EXPECT_NO_THROW(GetParam().run(bytes));
}

}  // namespace
}  // namespace dapple::fuzz
