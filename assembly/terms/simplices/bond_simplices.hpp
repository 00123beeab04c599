#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <variant>
#include <vector>

#include "assembly/terms/interaction.hpp"
#include "assembly/terms/simplices/local_workspace.hpp"
#include "assembly/terms/simplices/simplex_term.hpp"
#include "src/neighbourhood/lower_neighbours.hpp"

namespace peristat {

/// The triangles and tetrahedra that stand on one bond.
template <int D>
class BondSimplices {
 public:
  BondSimplices(const SimplexTerm& term, const Points& points)
      : term_(term), points_(points), bonds_(term.bonds()), below_(term.bonds()) {}

  /// What the bond i-j would set free by them with its integrity, see SimplexKernels::releases [J].
  /// @param influences with integrities of all bonds
  [[nodiscard]] double release(Index i, Index j, std::span<const double> displacement,
                               const Influences& influences) {
    find_apexes(i, j);
    double sum = 0.0;
    for (std::size_t a = 0; a < apexes_.size(); ++a) {
      const Apex& one = apexes_[a];
      const double left = influences.of_bond[std::size_t(one.to_first)] *
                          influences.of_bond[std::size_t(one.to_second)];
      if (left == 0.0) continue;
      if (term_.triangles()) {
        sum += left * energy<Area>(*term_.triangles(), {i, j, one.point}, displacement, influences);
      }
      if constexpr (D == 3) {
        if (!term_.tetrahedra()) continue;
        for_each_above(a, [&](const Apex& other, Offset between) {
          const double of_edges = left * influences.of_bond[std::size_t(other.to_first)] *
                                  influences.of_bond[std::size_t(other.to_second)] *
                                  influences.of_bond[std::size_t(between)];
          if (of_edges == 0.0) return;
          sum += of_edges * energy<Volume>(*term_.tetrahedra(), {i, j, one.point, other.point},
                                           displacement, influences);
        });
      }
    }
    return sum;
  }

 private:
  /// A common neighbour of the bond's points, with its bonds to them.
  struct Apex {
    Index point;
    Offset to_first, to_second;
  };

  void find_apexes(Index i, Index j) {
    of_first_.clear();
    apexes_.clear();
    below_.for_each_neighbour(bonds_, i, [&](Index k, Offset bond) {
      of_first_.push_back({k, bond, 0});
    });
    auto next = of_first_.begin();
    below_.for_each_neighbour(bonds_, j, [&](Index k, Offset bond) {
      while (next != of_first_.end() && next->point < k) ++next;
      if (next != of_first_.end() && next->point == k) apexes_.push_back({k, next->to_first, bond});
    });
  }

  /// Calls visit(apex, bond) for the later apexes that apex a has a bond to.
  template <class Visit>
  void for_each_above(std::size_t a, const Visit& visit) const {
    const Index point = apexes_[a].point;
    Offset bond = bonds_.offset[point];
    const Offset end = bonds_.offset[point + 1];
    for (std::size_t b = a + 1; b < apexes_.size(); ++b) {
      while (bond < end && bonds_.partner(point, bond) < apexes_[b].point) ++bond;
      if (bond < end && bonds_.partner(point, bond) == apexes_[b].point) visit(apexes_[b], bond);
    }
  }

  template <class Measure>
  [[nodiscard]] double energy(const Simplices<Measure>& kind,
                              std::array<Index, Measure::arms + 1> of,
                              std::span<const double> displacement,
                              const Influences& influences) const {
    std::ranges::sort(of);
    const InteractionBlock block = kind.interactions.template of_points<D>(points_, of);
    if (block.active == 0) return 0.0;
    Arms<Measure::arms, D, double> reference, moved;
    for (std::size_t a = 0; a < Measure::arms; ++a) {
      reference[a] = arm(points_.reference, of.front(), of[a + 1]);
      moved[a] = arm(displacement, of.front(), of[a + 1]);
    }
    auto measure =
        Measure::template at<D, double>(double(block.inverse_reference[0]), reference, moved);
    if (!influences.eigenstretch.empty()) {
      double free = 0.0;
      for (const Index point : of) free += influences.eigenstretch[std::size_t(point)];
      measure.relative_change -= free_growth<Measure::arms>(free / double(of.size()));
    }
    return std::visit(
        [&](const auto& law) {
          return interaction_energy(double(block.weight[0]), law, measure).value;
        },
        kind.potential);
  }

  [[nodiscard]] static Vector<D, double> arm(std::span<const double> field, Index from, Index to) {
    Vector<D, double> result;
    for (int c = 0; c < D; ++c) {
      result[c] = field[std::size_t(to) * D + c] - field[std::size_t(from) * D + c];
    }
    return result;
  }

  const SimplexTerm& term_;
  const Points& points_;
  const Bonds& bonds_;
  LowerNeighbours below_;
  std::vector<Apex> of_first_, apexes_;  // scratch
};

}  // namespace peristat
