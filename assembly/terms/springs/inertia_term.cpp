#include "assembly/terms/springs/inertia_term.hpp"

#include "assembly/terms/springs/spring_passes.hpp"

namespace peristat {

std::unique_ptr<TermPasses> InertiaTerm::passes(const TermSetting& setting) const {
  return std::make_unique<SpringPasses<InertiaTerm>>(*this, setting.points.dimension);
}

}  // namespace peristat
