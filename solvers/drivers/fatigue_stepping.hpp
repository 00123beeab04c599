#pragma once

#include <string>
#include <vector>

#include "assembly/borne_stretches.hpp"
#include "solvers/drivers/implicit_stepping.hpp"

namespace peristat {

/// Fatigue in cycles of the load ([Silling and Askari 2014]). Implicit steps raise the load to the
/// end of the programme, the largest load of a cycle, which is then held. The least load of a cycle
/// is R times as large, and the body is elastic in between: the stretch of a bond varies between s
/// and R s, and its life falls at the rate of its law (LifeLaw).
///
/// A block of cycles ends when the first bond has no life left: between two such events neither the
/// equilibrium nor a rate changes, so that a block is exact however long it is. The bond breaks
/// with those that tie with it (worn_bonds), and the body is equilibrated at the same load. Bonds
/// that this stretches beyond what they bear break as in any static step, one equilibrium after the
/// other, until none does.
///
/// The body fails if its loads end up on pieces that have come off, or if no equilibrium is found
/// while bonds break by their stretch. The last state is then the one before these bonds broke, at
/// the number of cycles at which they do.
///
/// Energies: a bond dissipates what it stores when it breaks at the end of its life, and by its
/// stretch what its law says. What else the body releases is drained.
class FatigueStepping : public Driver {
 public:
  explicit FatigueStepping(Path& path) : Driver(path), implicit_(path) {}

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// A block of cycles in progress.
  struct Block {
    Attempt attempt;
    FoundStep found;
    std::string fault;
    bool has_pinned = false;  ///< further degrees of freedom than before
    bool has_failed = false;  ///< the body does not bear the largest load any more
    Index worn = 0;           ///< bonds at the end of their life
    Index overstretched = 0;  ///< bonds that broke by their stretch
  };

  void begin_cycles();
  /// Marks bonds that a crack has come near to.
  void note_cracks(const History& history);
  [[nodiscard]] bool has_made_cycles() const;
  [[nodiscard]] bool has_made_blocks() const;
  /// Loss of life per cycle of each bond in the accepted state; 0 for those that do not age.
  [[nodiscard]] std::vector<double> life_rates() const;
  /// Lets lives pass.
  void age(const std::vector<double>& rates, double cycles);
  [[nodiscard]] Advance take_block();
  /// Breaks bonds at the end of their life, and equilibrates the body.
  [[nodiscard]] Block break_bonds(const std::vector<Offset>& worn);
  /// Equilibrates a body whose bonds have broken, and breaks those that this overstretches.
  void equilibrate(State from, Block& block);
  /// Breaks the bonds of a state that are at the end of their life.
  [[nodiscard]] State without(const std::vector<Offset>& worn, Block& block);
  /// Pins what has come off before the equilibrium is searched.
  [[nodiscard]] bool pin_loose(const State& at, Block& block);
  [[nodiscard]] Advance accept(Block block);
  /// Accepts the present equilibrium after further cycles in which no bond breaks.
  [[nodiscard]] Advance accept_unbroken(const std::string& how);
  /// Ends the path after a block without an equilibrium at its end.
  /// @param before the path at the beginning of the block
  [[nodiscard]] Advance fail(Block block, PathState before);
  /// Ends the path, which is complete.
  [[nodiscard]] Advance end(const std::string& why);
  [[nodiscard]] NewtonOptions held() const;
  [[nodiscard]] const FatigueOptions& fatigue() const { return path_.options().fatigue; }

  ImplicitStepping implicit_;
};

}  // namespace peristat
