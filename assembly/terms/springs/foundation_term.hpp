#pragma once

#include <memory>

#include "assembly/terms/springs/spring_term.hpp"
#include "src/conditions/foundations.hpp"

namespace peristat {

/// The springs of elastic foundations: k (u - g)^2 / 2 per component.
class FoundationTerm : public SpringTerm {
 public:
  FoundationTerm(const Points& points, const Foundations& foundations)
      : SpringTerm(points), foundations_(foundations) {}

  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  const Foundations& foundations_;
};

}  // namespace peristat
