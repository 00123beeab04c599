#pragma once

#include <vector>

#include "assembly/energy/state.hpp"

namespace peristat {

/// State at which an operator stays linearised.
class KeptState {
 public:
  void keep(const StateView& at) {
    displacement_.assign(at.displacement.begin(), at.displacement.end());
    history_ = at.history;
    damage_ = at.damage;
    environment_ = at.environment;
    has_contacts_ = at.has_contacts;
    foreseen_.assign(at.foreseen.begin(), at.foreseen.end());
  }
  [[nodiscard]] StateView view() const {
    StateView view(displacement_, history_, damage_, environment_);
    view.foreseen = foreseen_;
    view.has_contacts = has_contacts_;
    return view;
  }
  /// Current positions of points with these reference positions.
  [[nodiscard]] std::vector<double> positions(std::vector<double> reference) const {
    for (std::size_t k = 0; k < displacement_.size(); ++k) reference[k] += displacement_[k];
    return reference;
  }

 private:
  std::vector<double> displacement_;
  History history_;
  Damage damage_ = Damage::grows;
  SharedEnvironment environment_;
  std::vector<double> foreseen_;
  bool has_contacts_ = true;
};

}  // namespace peristat
