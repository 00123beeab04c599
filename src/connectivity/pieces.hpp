#pragma once

#include <span>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/connectivity/rigid_motions.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Connected component of the body, with this rank's part of it.
struct Piece {
  std::vector<Index> members;  ///< points of this rank, ascending
  GlobalIndex points = 0;      ///< of the whole piece, without images
  GlobalIndex lowest = 0;      ///< its lowest point's number in the whole body
  /// True if several ranks have points of it, or bonds to them: all ranks list it, in the same
  /// order.
  bool is_shared = false;
};

/// Returns the connected components of bonds and links: those that ranks share first, then the
/// others by their lowest points. Every rank joins its own points, and the ranks exchange the pairs
/// of components that ghosts connect: one exchange, however far a piece reaches. Components of
/// images alone are left out.
/// @param broken one flag per bond; empty: none is
/// @param links pairs of points here that are joined, too
/// @param ties points of several ranks that are joined, see Holding
/// Collective.
[[nodiscard]] std::vector<Piece> pieces_of(const Points& points, const Bonds& bonds,
                                           std::span<const char> broken,
                                           std::span<const BondEnds> links,
                                           std::span<const Index> ties, const IndexMap& index_map);

/// Free rigid motions of pieces, and pins that suppress them. Collective if ranks share the body.
class FreePieces {
 public:
  /// All must outlive it.
  /// @param positions points x dimension [m]
  FreePieces(const Points& points, std::span<const double> positions, const Holding& holding,
             const IndexMap& index_map)
      : points_(points), positions_(positions), holding_(holding), index_map_(index_map) {}

  /// Returns the free rigid motions of each piece, see free_rigid_motions.
  [[nodiscard]] std::vector<RigidMotions> motions(const std::vector<Piece>& pieces) const;

  /// Pins each piece by determinate_pins.
  /// @param motions of each piece
  /// @param held per degree of freedom: must not be pinned
  /// @param pinned likewise; gets the pins
  void pin(const std::vector<Piece>& pieces, const std::vector<RigidMotions>& motions,
           const std::vector<char>& held, std::vector<char>& pinned) const;

 private:
  [[nodiscard]] Coordinates place(Index point) const;
  [[nodiscard]] std::vector<RigidMotions> shared_motions(std::span<const Piece> pieces) const;
  void pin_shared(std::span<const Piece> pieces, std::span<const RigidMotions> motions,
                  const std::vector<char>& held, std::vector<char>& pinned) const;
  /// Pins on all ranks the handles that one rank has pinned.
  void tell_pinned_handles(std::vector<char>& pinned) const;

  const Points& points_;
  std::span<const double> positions_;
  const Holding& holding_;
  const IndexMap& index_map_;
};

}  // namespace peristat
