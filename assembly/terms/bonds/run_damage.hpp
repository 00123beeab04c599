#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "src/core/lanes.hpp"
#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {

/// True if a bond with this history has no force at any stretch.
template <class OfBond>
[[nodiscard]] bool bears_nothing(const OfBond& of_bond, double largest_stretch) {
  return of_bond.is_broken(largest_stretch) && !of_bond.closes;
}

/// Which bonds of a run need more than the potential of undamaged ones. A batch is lane_count
/// consecutive bonds of the run.
class RunDamage {
 public:
  double free_below = std::numeric_limits<double>::infinity();  ///< the lowest onset of a bond

  /// True if a bond has been noted.
  [[nodiscard]] bool any() const { return !flags_.empty(); }
  /// Bits of the lanes of a batch whose bonds are damaged and bear a load.
  [[nodiscard]] unsigned damaged(std::size_t batch) const { return flags_[batch] & 15u; }
  /// Bits of the lanes of a batch whose bonds bear nothing any more.
  [[nodiscard]] unsigned broken(std::size_t batch) const { return unsigned(flags_[batch]) >> 4; }

  /// Notes the damage of a bond of the run's point number `of`.
  void note(const BondRun& run, Index of, bool is_broken) {
    flags_.resize(std::size_t(run.points + lane_count - 1) / lane_count, 0);
    std::uint8_t& flags = flags_[std::size_t(of) / lane_count];
    const unsigned bit = 1u << (of % lane_count);
    flags = std::uint8_t((flags & ~(bit | bit << 4)) | (is_broken ? bit << 4 : bit));
  }

 private:
  static_assert(lane_count == 4, "two flags of four lanes fill a byte");
  std::vector<std::uint8_t> flags_;  // of batches; empty: no bond is damaged
};

}  // namespace peristat
