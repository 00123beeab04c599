#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solvers/equilibrium.hpp"
#include "src/conditions/fragments.hpp"

namespace peristat {

/// What becomes of pieces that come off, and of points that hang on too few bonds.
enum class FragmentRemedy {
  hold,    ///< just enough of their degrees of freedom are pinned that they can't move freely
  remove,  ///< all degrees of freedom of a piece leave the equations; loose points are held
  stop,    ///< the run ends
};

/// Pins that hold what has come off: no support, and no reaction. They do no work: what they hold
/// doesn't move, and when they are taken away nothing follows them.
class FragmentPins {
 public:
  /// @param prescribed per degree of freedom; outlives the pins
  /// @param free what the supports leave free; outlives the pins
  FragmentPins(const std::vector<char>& prescribed, const FreeDofs& free, FragmentRemedy remedy);

  /// Looks for what has come off in a state; nothing is pinned yet.
  void find(const Assembler& assembler, const State& state);

  /// Whether what was found last asks for other pins than there are.
  [[nodiscard]] bool are_outdated() const {
    return !found_.pinned.empty() && found_.pinned != pinned_;
  }
  /// Whether pieces were found that float, and shall end the run.
  [[nodiscard]] bool shall_stop() const {
    return remedy_ == FragmentRemedy::stop && found_.count > 0;
  }
  [[nodiscard]] bool removes_pieces() const { return remedy_ == FragmentRemedy::remove; }

  /// Pins what was found last, and numbers the equations anew.
  void pin();

  /// Whether anything was ever pinned.
  [[nodiscard]] bool have_pinned() const { return own_free_ != nullptr; }

  /// The equations, without what is pinned.
  [[nodiscard]] const FreeDofs& free() const { return own_free_ ? *own_free_ : free_; }

  /// Forces of the pins, their 2-norm [N].
  [[nodiscard]] double force(const Trial& state, std::span<const double> external_force) const;

  /// Per point, see Fragments; empty before anything was looked for.
  [[nodiscard]] std::span<const std::int32_t> piece() const { return found_.piece; }

  /// What was found last, for a person.
  [[nodiscard]] std::string described() const;

 private:
  void remove_pieces();

  const std::vector<char>& prescribed_;
  const FreeDofs& free_;
  FragmentRemedy remedy_;
  Fragments found_;
  std::vector<char> pinned_;            // per degree of freedom
  std::unique_ptr<FreeDofs> own_free_;  // once something is pinned
};

}  // namespace peristat
