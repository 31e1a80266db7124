// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/half_spaces.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dapple {
namespace {

constexpr std::size_t kBlock = HalfSpaces::kBlock;
constexpr std::size_t kY = kBlock, kZ = 2 * kBlock, kOffset = 3 * kBlock;
using Triangle = HalfSpaces::Triangle;

// One function for each instruction set. All of them round each product and each sum separately, in
// the order of Triple::dot(), so that results are identical to those of scalar code.

#if defined(__x86_64__)

unsigned compare_sse2(const double* block, const Triangle& triangle, double floor) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < kBlock; k += 2) {
    const double* lane = block + k;
    const __m128d x = _mm_loadu_pd(lane), y = _mm_loadu_pd(lane + kY), z = _mm_loadu_pd(lane + kZ);
    const __m128d offset = _mm_loadu_pd(lane + kOffset);
    __m128d reached = _mm_setzero_pd();
    for (const Triple& p : triangle) {
      const __m128d xy =
          _mm_add_pd(_mm_mul_pd(_mm_set1_pd(p.x), x), _mm_mul_pd(_mm_set1_pd(p.y), y));
      const __m128d side = _mm_sub_pd(_mm_add_pd(xy, _mm_mul_pd(_mm_set1_pd(p.z), z)), offset);
      reached = _mm_or_pd(reached, _mm_cmpge_pd(side, _mm_set1_pd(floor)));
    }
    bits |= static_cast<unsigned>(_mm_movemask_pd(reached)) << k;
  }
  return bits;
}

[[gnu::target("avx2")]] unsigned compare_avx2(const double* block, const Triangle& triangle,
                                              double floor) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < kBlock; k += 4) {
    const double* lane = block + k;
    const __m256d x = _mm256_loadu_pd(lane), y = _mm256_loadu_pd(lane + kY);
    const __m256d z = _mm256_loadu_pd(lane + kZ), offset = _mm256_loadu_pd(lane + kOffset);
    __m256d reached = _mm256_setzero_pd();
    for (const Triple& p : triangle) {
      const __m256d xy = _mm256_add_pd(_mm256_mul_pd(_mm256_set1_pd(p.x), x),
                                       _mm256_mul_pd(_mm256_set1_pd(p.y), y));
      const __m256d side =
          _mm256_sub_pd(_mm256_add_pd(xy, _mm256_mul_pd(_mm256_set1_pd(p.z), z)), offset);
      reached = _mm256_or_pd(reached, _mm256_cmp_pd(side, _mm256_set1_pd(floor), _CMP_GE_OQ));
    }
    bits |= static_cast<unsigned>(_mm256_movemask_pd(reached)) << k;
  }
  return bits;
}

[[gnu::target("avx512f")]] unsigned compare_avx512(const double* block, const Triangle& triangle,
                                                   double floor) {
  const __m512d x = _mm512_loadu_pd(block), y = _mm512_loadu_pd(block + kY);
  const __m512d z = _mm512_loadu_pd(block + kZ), offset = _mm512_loadu_pd(block + kOffset);
  unsigned bits = 0;
  for (const Triple& p : triangle) {
    const __m512d xy =
        _mm512_add_pd(_mm512_mul_pd(_mm512_set1_pd(p.x), x), _mm512_mul_pd(_mm512_set1_pd(p.y), y));
    const __m512d side =
        _mm512_sub_pd(_mm512_add_pd(xy, _mm512_mul_pd(_mm512_set1_pd(p.z), z)), offset);
    bits |= _mm512_cmp_pd_mask(side, _mm512_set1_pd(floor), _CMP_GE_OQ);
  }
  return bits;
}

#else

unsigned compare_single(const double* block, const Triangle& triangle, double floor) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const Triple normal(block[k], block[kY + k], block[kZ + k]);
    for (const Triple& p : triangle)
      bits |= static_cast<unsigned>(p.dot(normal) - block[kOffset + k] >= floor) << k;
  }
  return bits;
}

#endif

}  // namespace

const char* name_of(InstructionSet set) {
  constexpr const char* kNames[] = {"single", "sse2", "avx2", "avx512"};
  return kNames[static_cast<int>(set)];
}

std::vector<InstructionSet> instruction_sets() {
#if defined(__x86_64__)
  std::vector<InstructionSet> sets = {InstructionSet::kSse2};
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::kAvx2);
  if (__builtin_cpu_supports("avx512f")) sets.push_back(InstructionSet::kAvx512);
  return sets;
#else
  return {InstructionSet::kSingle};
#endif
}

HalfSpaces::HalfSpaces(InstructionSet set) : compare_(nullptr) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::kSse2:
      compare_ = compare_sse2;
      break;
    case InstructionSet::kAvx2:
      compare_ = compare_avx2;
      break;
    case InstructionSet::kAvx512:
      compare_ = compare_avx512;
      break;
    case InstructionSet::kSingle:
      break;
#else
    default:
      compare_ = compare_single;
#endif
  }
}

void HalfSpaces::assign(std::size_t k, const Vec3& normal, double offset) {
  const std::size_t block = kWidth * (k / kBlock);
  if (coordinates_.size() < block + kWidth) coordinates_.resize(2 * (block + kWidth));
  double* lane = coordinates_.data() + block + k % kBlock;
  lane[0] = normal[0];
  lane[kY] = normal[1];
  lane[kZ] = normal[2];
  lane[kOffset] = offset;
}

}  // namespace dapple
