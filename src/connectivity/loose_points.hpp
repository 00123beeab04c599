#pragma once

#include <span>
#include <utility>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// The unbroken bonds of a body in its present state.
class Web {
 public:
  /// The bonds must outlive it.
  /// @param broken one flag per bond, or empty
  /// @param positions points x dimension [m]
  Web(const Bonds& bonds, std::span<const char> broken, int dimension,
      std::vector<double> positions)
      : bonds_(bonds), broken_(broken), dimension_(dimension), positions_(std::move(positions)) {}

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  /// Padded with zeros to three components.
  [[nodiscard]] Coordinates position(Index i) const;

  /// visit(i, j, bond), i < j, for every unbroken bond.
  template <class Visit>
  void for_each_bond(const Visit& visit) const {
    for (Index i = 0; i < bonds_.points(); ++i) for_each_above(i, visit);
  }

  /// visit(j) for the upper points of the unbroken bonds of a point, until it returns false.
  template <class Visit>
  void for_each_above_while(Index i, const Visit& visit) const {
    for (Offset bond = bonds_.offset[i]; bond < bonds_.offset[i + 1]; ++bond) {
      const bool is_broken = !broken_.empty() && broken_[bond];
      if (!is_broken && !visit(bonds_.partner(i, bond))) return;
    }
  }

  /// Prepares for_each_partner.
  void find_lower_partners();

  /// visit(j) for the points at the other ends of the unbroken bonds of a point.
  template <class Visit>
  void for_each_partner(Index i, const Visit& visit) const {
    for (Offset k = lower_offset_[i]; k < lower_offset_[i + 1]; ++k) visit(lower_partner_[k]);
    for_each_above(i, [&](Index, Index j, Offset) { visit(j); });
  }

 private:
  template <class Visit>
  void for_each_above(Index i, const Visit& visit) const {
    for (Offset bond = bonds_.offset[i]; bond < bonds_.offset[i + 1]; ++bond) {
      if (broken_.empty() || !broken_[bond]) visit(i, bonds_.partner(i, bond), bond);
    }
  }

  const Bonds& bonds_;
  std::span<const char> broken_;
  int dimension_;
  std::vector<double> positions_;
  std::vector<Offset> lower_offset_;
  std::vector<Index> lower_partner_;
};

/// Sum of n n^T over the directions n that support a point, symmetric. Directions beyond the
/// dimension count as supported.
using Support = Tensor;

/// True if the first `own` points are held in all directions. Most are after a look at some of
/// their bonds.
/// @param prescribed per degree of freedom
[[nodiscard]] bool hold_all(const Web& web, Index own, const std::vector<char>& prescribed,
                            const std::vector<FreeHandle>& handles);

/// @param prescribed as above
[[nodiscard]] std::vector<Support> supports_of(const Web& web, Index count,
                                               const std::vector<char>& prescribed,
                                               const std::vector<FreeHandle>& handles);

/// Strips loose points until none is left (see find_fragments), and subtracts them from the
/// supports of all points.
/// Collective, supports of ghosts are not used
/// @return per point, 1 if it is loose
[[nodiscard]] std::vector<char> strip_loose_points(Web& web, std::vector<Support>& support,
                                                   const IndexMap& index_map);

/// Pins loose points one by one, those that need the fewest pins first (then the lowest); each then
/// supports the others by its bonds. With `index_map`: collective, all ranks get all loose points.
/// @param support of each point by points that are not loose
/// @param pinned per degree of freedom; gets the pins
/// @param loose this rank's own, ascending
void pin_loose_points(const Web& web, const std::vector<Index>& loose,
                      const std::vector<FreeHandle>& handles, std::vector<Support> support,
                      const IndexMap& index_map, std::vector<char>& pinned);

}  // namespace peristat
