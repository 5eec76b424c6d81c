#pragma once

/// Functions compiled a second time for processors that have more than the plain instruction set.

#if defined(__x86_64__)
/// Shifts by any register, deposits of bits (BMI 2); counts of leading zeros.
#define STRATA_TARGET_BMI2 __attribute__((target("bmi,bmi2,lzcnt")))
/// Vectors of 32 bytes (no fused multiply-add: results are those of the plain set).
#define STRATA_TARGET_AVX2 __attribute__((target("avx2")))
#else
#define STRATA_TARGET_BMI2
#define STRATA_TARGET_AVX2
#endif

namespace strata {

/// Whether what is compiled for STRATA_TARGET_BMI2 runs here, and fast: the first two Zens take long over deposits.
inline bool hasBmi2() {
#if defined(__x86_64__)
  static const bool has =
      __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_is("znver1") == 0 && __builtin_cpu_is("znver2") == 0;
  return has;
#else
  return false;
#endif
}

/// Whether what is compiled for STRATA_TARGET_AVX2 runs here.
inline bool hasAvx2() {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

/// `fields`' lowest bits go, in order, to where `places` has bits.
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
