#pragma once

#include <cstdint>

namespace peristat {

/// Mixes the bits of a number: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
[[nodiscard]] inline std::uint64_t scattered(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

/// Random number that depends on a seed and a counter alone, not on numbers drawn before.
[[nodiscard]] inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter) {
  return scattered(scattered(seed) + 0x9e3779b97f4a7c15u * (counter + 1));
}

/// Random bits as a number strictly between 0 and 1.
[[nodiscard]] inline double open_unit(std::uint64_t bits) {
  return (double(bits >> 12) + 0.5) * 0x1p-52;
}

}  // namespace peristat
