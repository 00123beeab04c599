#pragma once

#include <span>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/connectivity/rigid_motions.hpp"
#include "src/core/sharing.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What hangs together of a body, as far as it is here.
struct Piece {
  std::vector<Index> members;  ///< that are this rank's, ascending
  GlobalIndex points = 0;      ///< of the whole piece, without images
  GlobalIndex lowest = 0;      ///< its lowest point's number in the whole body
  /// Several ranks have points of it, or bonds to them: all ranks list it, in the same order.
  bool is_shared = false;
};

/// The pieces that bonds and links make: those that ranks share first, then the others by their
/// lowest points. Of a shared body every rank joins its own points, and tells the others which of
/// its pieces ghosts tie to which of theirs: one exchange, however far a piece reaches. Pieces of
/// images alone, beyond reach of the body, are none.
/// @param broken one flag per bond; empty: none is
/// @param links pairs of points here that are joined, too
/// @param ties of a shared body points of several ranks that are joined, see Holding
/// @param sharing null: the body is whole. Otherwise a call that all ranks make
[[nodiscard]] std::vector<Piece> pieces_of(const Points& points, const Bonds& bonds,
                                           std::span<const char> broken,
                                           std::span<const BondEnds> links,
                                           std::span<const Index> ties, const Sharing* sharing);

/// What moves freely of some pieces, and how to pin it. Of a shared body calls that all ranks make.
class FreePieces {
 public:
  /// All must outlive it.
  /// @param positions points x dimension [m]
  FreePieces(const Points& points, std::span<const double> positions, const Holding& holding,
             const Sharing* sharing)
      : points_(points), positions_(positions), holding_(holding), sharing_(sharing) {}

  /// See free_rigid_motions, of each piece.
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
  /// Those that one rank has pinned all have.
  void tell_pinned_handles(std::vector<char>& pinned) const;

  const Points& points_;
  std::span<const double> positions_;
  const Holding& holding_;
  const Sharing* sharing_;
};

}  // namespace peristat
