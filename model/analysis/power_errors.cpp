// SPDX-License-Identifier: MIT
// power_errors: the least and the greatest error of cos(s)^n over every code of 1 - cos(s), for all
// codes of n with the same whole part. The formats and tables are in power_tables.h, which
// phong75.model.analysis.exhausted writes from the configuration; the stages are those of
// model/twin/core/specular_power_tables.py.
//
//   power_errors rows FIRST LAST   one line a whole part of n, as soon as it is done
//   power_errors codes             reads pairs "v n" of codes, writes the code of each power
//
// A line of `rows`: whole part, pairs, least error, its v, its n, greatest error, its v, its n.
// Errors are code / 2^POWER_FRACTION - (1 - v)^n in double precision, each within MARGIN of the
// true error. (1 - v)^n is pow() at the first n of a row, and one product with pow(1 - v, 1/one)
// for each further n: at most 2^EXPONENT_FRACTION products, each wrong by at most an ulp of its
// factor and half an ulp of its own, so that the relative error stays below 2^-40 for a pow() that
// is wrong by at most 4 ulp.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "power_tables.h"

namespace {

constexpr int64_t kOne = int64_t{1} << VERSINE_FRACTION;    // codes of v
constexpr int64_t kExponentOne = int64_t{1} << EXPONENT_FRACTION;
constexpr int kOffsetBits = VERSINE_FRACTION - 1 - LOG_INDEX_BITS;
constexpr int kExpOffsetBits = POWER_LOG_FRACTION - EXP_INDEX_BITS;
constexpr int kMost = LOG_BITS - LOG_MANTISSA_BITS;
constexpr int kDrop = LOG_VALUE_FRACTION + EXPONENT_FRACTION - POWER_LOG_FRACTION - kMost;
constexpr int kPowerDrop = EXP_VALUE_FRACTION - POWER_FRACTION;
constexpr int64_t kPowerMax = (int64_t{1} << POWER_FRACTION) - 1;
constexpr int kBlock = 1024;

int leading_zeros(int64_t word, int bits) {
  int zeros = 0;
  while (zeros < bits && !(word >> (bits - 1 - zeros) & 1)) zeros++;
  return zeros;
}

// leading_ones, log_lookup, log_refine, log_normalize: the mantissa of -log2(cos s), and the shift
// of its product with n.
void logarithm(int64_t v, uint32_t &mantissa, uint32_t &shift) {
  int64_t e, t;
  if (LOG_OCTAVES) {
    e = leading_zeros((kOne - 1) - v, VERSINE_FRACTION);
    t = (v << e) & (kOne - 1);
  } else {
    e = v >> (VERSINE_FRACTION - 1);
    t = v & (kOne / 2 - 1);
  }
  const int64_t address = (t >> kOffsetBits) & ((1 << LOG_INDEX_BITS) - 1);
  const int64_t offset = t & ((int64_t{1} << kOffsetBits) - 1);
  const int64_t g = (e << LOG_VALUE_FRACTION) + log_values[address] +
                    ((int64_t{log_slopes[address]} * offset) >> kOffsetBits);
  const int k = std::min(leading_zeros(g, LOG_BITS), kMost);
  mantissa = static_cast<uint32_t>((g << k) >> kMost);
  shift = kDrop + k;
}

// times_exponent
inline uint32_t product(uint32_t mantissa, uint32_t shift, uint32_t n) {
  const uint64_t x = (uint64_t{mantissa} * n) >> shift;
  return static_cast<uint32_t>(std::min<uint64_t>(x, POWER_LOG_MAX));
}

// exp_lookup, exp_refine, exp_shift
inline int32_t power(uint32_t x) {
  const uint32_t address = (x >> kExpOffsetBits) & ((1u << EXP_INDEX_BITS) - 1);
  const uint32_t offset = x & ((1u << kExpOffsetBits) - 1);
  const uint32_t whole = x >> POWER_LOG_FRACTION;
  const uint32_t line = exp_values[address] - ((exp_slopes[address] * offset) >> kExpOffsetBits);
  const uint32_t rounded = ((line >> whole) + (1u << (kPowerDrop - 1))) >> kPowerDrop;
  return static_cast<int32_t>(std::min<uint32_t>(rounded, kPowerMax));
}

// specular_cosine
int32_t cosine(int64_t v) {
  constexpr int drop = VERSINE_FRACTION - POWER_FRACTION;
  return static_cast<int32_t>(
      std::min<int64_t>((kOne - v + (int64_t{1} << (drop - 1))) >> drop, kPowerMax));
}

struct Worst {
  double least = 1, greatest = -1;
  int64_t least_v = 0, least_n = 0, greatest_v = 0, greatest_n = 0;

  void see(double error, int64_t v, int64_t n) {
    if (error < least) least = error, least_v = v, least_n = n;
    if (error > greatest) greatest = error, greatest_v = v, greatest_n = n;
  }
};

// All codes of n from `first` to `last` for the codes of v from `v` to `v` + kBlock - 1.
void block(int64_t v, int64_t first, int64_t last, Worst &worst) {
  alignas(64) double exact[kBlock], ratio[kBlock], error[kBlock];
  alignas(64) uint32_t mantissa[kBlock], shift[kBlock];
  bool vanishes = true;
  for (int i = 0; i < kBlock; i++) {
    logarithm(v + i, mantissa[i], shift[i]);
    // Where 2^-x is shifted out, the power is 0 for this n and for all larger ones, since x grows.
    const uint32_t whole = product(mantissa[i], shift[i], first) >> POWER_LOG_FRACTION;
    vanishes = vanishes && whole >= EXP_VALUE_FRACTION && first > kExponentOne;
  }
  const auto base = [](int64_t code) { return std::ldexp(kOne - code, -VERSINE_FRACTION); };
  const double n = std::ldexp(first, -EXPONENT_FRACTION);
  if (vanishes) {
    worst.see(-std::pow(base(v), n), v, first);  // (1 - v)^n falls with v and with n
    return;
  }
  for (int i = 0; i < kBlock; i++) {
    exact[i] = std::pow(base(v + i), n);
    ratio[i] = std::pow(base(v + i), 1.0 / kExponentOne);
  }
  for (int64_t code = first; code <= last; code++) {
    const uint32_t multiple = static_cast<uint32_t>(code);
    const bool bypass = POWER_BYPASS && code == kExponentOne;
    double low = 1, high = -1;
    if (bypass) {
      for (int i = 0; i < kBlock; i++)
        error[i] = cosine(v + i) * (1.0 / (kPowerMax + 1)) - exact[i];
    } else {
      for (int i = 0; i < kBlock; i++)
        error[i] = power(product(mantissa[i], shift[i], multiple)) * (1.0 / (kPowerMax + 1)) -
                   exact[i];
    }
    for (int i = 0; i < kBlock; i++) exact[i] *= ratio[i];
    for (int i = 0; i < kBlock; i++) low = std::min(low, error[i]);
    for (int i = 0; i < kBlock; i++) high = std::max(high, error[i]);
    if (low < worst.least || high > worst.greatest)
      for (int i = 0; i < kBlock; i++) worst.see(error[i], v + i, code);
  }
}

void row(int64_t whole) {
  const int64_t first = whole * kExponentOne;
  const int64_t last = std::min(first + kExponentOne - 1, int64_t{128} * kExponentOne);
  Worst worst;
  for (int64_t v = 0; v < kOne; v += kBlock) block(v, first, last, worst);
  std::printf("%lld %lld %.17g %lld %lld %.17g %lld %lld\n", static_cast<long long>(whole),
              static_cast<long long>(kOne * (last - first + 1)), worst.least,
              static_cast<long long>(worst.least_v), static_cast<long long>(worst.least_n),
              worst.greatest, static_cast<long long>(worst.greatest_v),
              static_cast<long long>(worst.greatest_n));
  std::fflush(stdout);
}

}  // namespace

int main(int count, char **arguments) {
  if (count == 4 && !std::strcmp(arguments[1], "rows")) {
    for (long whole = std::atol(arguments[2]); whole <= std::atol(arguments[3]); whole++) row(whole);
    return 0;
  }
  if (count == 2 && !std::strcmp(arguments[1], "codes")) {
    long long v, n;
    while (std::scanf("%lld %lld", &v, &n) == 2) {
      uint32_t mantissa, shift;
      logarithm(v, mantissa, shift);
      const bool bypass = POWER_BYPASS && n == kExponentOne;
      std::printf("%d\n", bypass ? cosine(v) : power(product(mantissa, shift, n)));
    }
    return 0;
  }
  std::fprintf(stderr, "power_errors rows FIRST LAST | power_errors codes\n");
  return 2;
}
