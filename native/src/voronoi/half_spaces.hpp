// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/types.hpp>
#include <vector>

#include "base/triple.hpp"

namespace dapple {

/// Instructions that compare one, two, four or eight numbers at once.
enum class InstructionSet { kSingle, kSse2, kAvx2, kAvx512 };

[[nodiscard]] const char* name_of(InstructionSet set);

/// The instruction sets of this machine, the widest last.
[[nodiscard]] std::vector<InstructionSet> instruction_sets();

/// Half-spaces x . normal <= offset as a structure of arrays, so that several are compared with a
/// triangle at once.
class HalfSpaces {
 public:
  static constexpr std::size_t kBlock = 8;  ///< compared at once
  using Triangle = std::array<Triple, 3>;

  explicit HalfSpaces(InstructionSet set = instruction_sets().back());

  void assign(std::size_t k, const Vec3& normal, double offset);

  /// A bit for each half-space of the block that starts at `first`, a multiple of kBlock, the
  /// lowest for `first`: whether a corner of the triangle has x . normal - offset >= floor. Bits of
  /// unassigned half-spaces are undefined. Every instruction set gives the same bits.
  /// \pre first was assigned
  [[nodiscard]] unsigned reached_by(std::size_t first, const Triangle& triangle,
                                    double floor) const {
    return compare_(coordinates_.data() + kWidth * (first / kBlock), triangle, floor);
  }

 private:
  // Of a block: x, y and z of the normals, then the offsets.
  static constexpr std::size_t kWidth = 4 * kBlock;

  std::vector<double> coordinates_;
  unsigned (*compare_)(const double* block, const Triangle& triangle, double floor);
};

}  // namespace dapple
