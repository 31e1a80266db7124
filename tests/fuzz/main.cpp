// SPDX-License-Identifier: GPL-3.0-or-later
// What a fuzzing engine calls. The name of the program says the target, fuzz_sample for one: each
// is the same program under another name.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>

#include "targets.hpp"

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

const dapple::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** arguments) {
  const std::string_view program = (*arguments)[0];
  for (const dapple::fuzz::Target& target : dapple::fuzz::kTargets)
    if (program.ends_with(std::string("fuzz_") + target.name)) chosen = &target;
  if (chosen == nullptr) {
    std::cerr << program << " ends with the name of no target\n";
    std::exit(1);
  }
  GTEST_FLAG_SET(throw_on_failure, true);  // nobody catches it, so the engine keeps the input
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dapple::fuzz::Bytes bytes({data, size});
  chosen->run(bytes);
  return 0;
}
