#pragma once

#include <memory>

#include "assembly/terms/springs/spring_term.hpp"
#include "src/conditions/obstacles.hpp"

namespace peristat {

/// The contacts of points with rigid obstacles. They couple no points.
class ObstacleTerm : public SpringTerm {
 public:
  ObstacleTerm(const Points& points, const Obstacles& obstacles)
      : SpringTerm(points), obstacles_(obstacles) {}

  /// Balances concern forces between points, of which obstacles have none.
  [[nodiscard]] Balances balances() const override { return {}; }
  [[nodiscard]] double stored_bytes() const override;

  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  const Obstacles& obstacles_;
};

}  // namespace peristat
