#include "assembly/terms/springs/foundation_term.hpp"

#include "assembly/terms/springs/spring_passes.hpp"

namespace peristat {

std::unique_ptr<TermPasses> FoundationTerm::passes(const TermSetting& setting) const {
  return std::make_unique<SpringPasses<Foundations>>(foundations_, setting.points.dimension);
}

}  // namespace peristat
