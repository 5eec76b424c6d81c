#pragma once

/// Attributes for functions that are compiled a second time, for processors with more than the plain instruction set,
/// and tests of the processor that choose between the two.

#if defined(__x86_64__)
/// BMI 2: shifts by any register, deposits of bits; also counts of leading zeros.
#define STRATA_TARGET_BMI2 __attribute__((target("bmi,bmi2,lzcnt")))
/// AVX 2: vectors of 32 bytes. Without fused multiply-add, so results equal those of the plain set.
#define STRATA_TARGET_AVX2 __attribute__((target("avx2")))
#else
#define STRATA_TARGET_BMI2
#define STRATA_TARGET_AVX2
#endif

namespace strata {

/// True when functions for STRATA_TARGET_BMI2 run here, and run fast: the first two Zens take long over deposits.
inline bool hasBmi2() {
#if defined(__x86_64__)
  static const bool has =
      __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_is("znver1") == 0 && __builtin_cpu_is("znver2") == 0;
  return has;
#else
  return false;
#endif
}

/// True when functions for STRATA_TARGET_AVX2 run here.
inline bool hasAvx2() {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

/// Moves the lowest bits of `fields`, in order, to the places where `places` has bits.
STRATA_TARGET_BMI2 inline unsigned depositBits(unsigned fields, unsigned places) {
#if defined(__x86_64__)
  return __builtin_ia32_pdep_si(fields, places);
#else
  unsigned out = 0;
  for (unsigned bit = 1; places != 0; places &= places - 1, bit <<= 1)
    if ((fields & bit) != 0) out |= places & -places;
  return out;
#endif
}

}  // namespace strata
