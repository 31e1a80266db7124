// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/eight_boxes.hpp"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dapple {
namespace {

// One function for each instruction set. All of them round each square and each sum separately, in
// the order of squared_distances(), and so give identical results. Of a number and a NaN, max
// instructions return their second operand: so a gap that is no number stays one and is not near,
// or a search would return the points that are missing in the last box.

#if defined(__x86_64__)

unsigned compare_sse2(const Eight& low, const Eight& high, const Box& query, double limit) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < 8; k += 2) {
    __m128d sum = _mm_setzero_pd();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const __m128d below = _mm_sub_pd(_mm_loadu_pd(&low[axis][k]), _mm_set1_pd(query.high[a]));
      const __m128d above = _mm_sub_pd(_mm_set1_pd(query.low[a]), _mm_loadu_pd(&high[axis][k]));
      const __m128d gap = _mm_max_pd(_mm_setzero_pd(), _mm_max_pd(below, above));
      sum = _mm_add_pd(sum, _mm_mul_pd(gap, gap));
    }
    bits |= static_cast<unsigned>(_mm_movemask_pd(_mm_cmplt_pd(sum, _mm_set1_pd(limit)))) << k;
  }
  return bits;
}

[[gnu::target("avx2")]] unsigned compare_avx2(const Eight& low, const Eight& high, const Box& query,
                                              double limit) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < 8; k += 4) {
    __m256d sum = _mm256_setzero_pd();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const __m256d below =
          _mm256_sub_pd(_mm256_loadu_pd(&low[axis][k]), _mm256_set1_pd(query.high[a]));
      const __m256d above =
          _mm256_sub_pd(_mm256_set1_pd(query.low[a]), _mm256_loadu_pd(&high[axis][k]));
      const __m256d gap = _mm256_max_pd(_mm256_setzero_pd(), _mm256_max_pd(below, above));
      sum = _mm256_add_pd(sum, _mm256_mul_pd(gap, gap));
    }
    const __m256d near = _mm256_cmp_pd(sum, _mm256_set1_pd(limit), _CMP_LT_OQ);
    bits |= static_cast<unsigned>(_mm256_movemask_pd(near)) << k;
  }
  return bits;
}

[[gnu::target("avx512f")]] unsigned compare_avx512(const Eight& low, const Eight& high,
                                                   const Box& query, double limit) {
  constexpr __mmask8 kAll = 0xff;  // without a mask, GCC 12 warns about uninitialized values
  __m512d sum = _mm512_setzero_pd();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const __m512d below =
        _mm512_sub_pd(_mm512_loadu_pd(low[axis].data()), _mm512_set1_pd(query.high[a]));
    const __m512d above =
        _mm512_sub_pd(_mm512_set1_pd(query.low[a]), _mm512_loadu_pd(high[axis].data()));
    const __m512d gap =
        _mm512_maskz_max_pd(kAll, _mm512_setzero_pd(), _mm512_maskz_max_pd(kAll, below, above));
    sum = _mm512_add_pd(sum, _mm512_mul_pd(gap, gap));
  }
  return _mm512_cmp_pd_mask(sum, _mm512_set1_pd(limit), _CMP_LT_OQ);
}

#else

unsigned compare_single(const Eight& low, const Eight& high, const Box& query, double limit) {
  unsigned bits = 0, bit = 1;
  for (const double distance : squared_distances(low, high, query)) {
    bits |= distance < limit ? bit : 0U;
    bit <<= 1;
  }
  return bits;
}

#endif

}  // namespace

CompareBoxes compare_boxes([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return compare_avx512;
  return set == InstructionSet::kAvx2 ? compare_avx2 : compare_sse2;
#else
  return compare_single;
#endif
}

std::array<double, 8> squared_distances(const Eight& low, const Eight& high, const Box& query) {
  std::array<double, 8> sums{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    for (std::size_t k = 0; k < 8; ++k) {
      const double gap =
          std::max(std::max(low[axis][k] - query.high[a], query.low[a] - high[axis][k]), 0.0);
      sums[k] += gap * gap;
    }
  }
  return sums;
}

}  // namespace dapple
