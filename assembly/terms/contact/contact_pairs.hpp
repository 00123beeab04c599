#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/communicator.hpp"
#include "src/potentials/contact_law.hpp"

namespace peristat {

/// How points touch one another.
struct PairContactRule {
  ContactLaw law{};
  double depth = 0.25;      ///< a: the largest depth over the distance of contact
  double stiffness = 1.0;   ///< alpha: over that of the bar of a pair of points
  double distance = 0.0;    ///< d_c [m]; 0: the mean of the two points' sizes
  bool has_faces = false;   ///< surfaces touch as ContactFaces, not as points
  double friction = 0.0;    ///< mu
  double tangential = 0.5;  ///< beta: stiffness of a contact that sticks over its stiffness
  /// Per point: 1 in the first set, 2 in the second, 0 in none; empty: all points touch one
  /// another.
  std::vector<char> side{};

  /// True if it is a rule of a pair.
  [[nodiscard]] bool holds_for(Index i, Index j) const {
    if (side.empty()) return true;
    const int one = side[std::size_t(i)], other = side[std::size_t(j)];
    return has_two_sides ? one + other == 3 && one != 0 && other != 0 : one == 1 && other == 1;
  }
  bool has_two_sides = false;
};

/// Points that can touch, with what their contact needs.
struct ContactPair {
  Index i = 0, j = 0;  ///< i < j
  std::int32_t rule = 0;
  double reference = 0.0;  ///< L [m]
  double distance = 0.0;   ///< d_ij [m]
  double stiffness = 0.0;  ///< k_ij [N/m]; half of it if j is an image
  Offset bond = -1;        ///< between them; -1: none
};

/// Pairs of points that can touch: no bond joins them that never fails. With the reference distance
/// L, Delta the mean of their sizes, E = 2 E_i E_j / (E_i + E_j) and the cross-section A of a cell
/// (3D: Delta^2, 2D: Delta times the thickness, 1D: that of the bar):
///
///   d = min(L, d_c),   k = alpha E A / d
///
/// so that rest is free of forces, and bonds break only where the gap is longer than d.
///
/// Points touch images of points, too. Such a contact is there twice, as that of i with the image
/// of j and as that of j with the image of i; each has half of k. Images touch no images: what
/// touches beyond a plane of symmetry or a period belongs to others. On several ranks a pair of an
/// own point and a ghost is on both.
class ContactPairs {
 public:
  /// The arguments outlive it.
  /// @param size per point [m]
  /// @param modulus Young's modulus per point [Pa]
  /// @param bonds_fail otherwise points with a bond never touch
  /// @param ranks that share the body
  ContactPairs(const Points& points, const Bonds& bonds, std::vector<PairContactRule> rules,
               std::vector<double> size, std::vector<double> modulus, double cross_section,
               bool bonds_fail, const Communicator& ranks = sole_rank());

  [[nodiscard]] const std::vector<PairContactRule>& rules() const { return rules_; }
  /// Distance beyond d that pairs are still listed [m].
  [[nodiscard]] double skin() const { return 0.5 * largest_size_; }
  /// The longest d, of all ranks [m].
  [[nodiscard]] double reach() const { return reach_; }
  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] std::span<const double> sizes() const { return size_; }      ///< per point [m]
  [[nodiscard]] std::span<const double> moduli() const { return modulus_; }  ///< per point [Pa]
  /// Area of the face of a cell of a size [m2]; in 1D the bar's cross-section.
  [[nodiscard]] double section(double size) const {
    return points_.dimension == 3   ? size * size
           : points_.dimension == 2 ? cross_section_ * size
                                    : cross_section_;
  }
  /// Memory of it, and of the pairs that are kept near a state where bonds can fail [bytes].
  [[nodiscard]] double bytes() const;

  /// The pair i < j.
  /// @return false if the two never touch
  [[nodiscard]] bool find_pair(Index i, Index j, ContactPair& pair) const;

  /// All pairs that are nearer than d + skin at a displacement, by i and then j.
  /// @param displacement finite
  [[nodiscard]] std::vector<ContactPair> near(std::span<const double> displacement,
                                              int threads) const;

 private:
  template <int D>
  [[nodiscard]] std::vector<ContactPair> near_in(std::span<const double> displacement,
                                                 int threads) const;

  const Points& points_;
  const Bonds& bonds_;
  std::vector<PairContactRule> rules_;
  std::vector<double> size_, modulus_;
  double cross_section_;  // 2D: thickness, 1D: area
  bool bonds_fail_;
  double largest_size_ = 0.0, reach_ = 0.0;
};

}  // namespace peristat
