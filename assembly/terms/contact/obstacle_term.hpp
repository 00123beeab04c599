#pragma once

#include <memory>

#include "assembly/terms/springs/spring_term.hpp"
#include "src/conditions/obstacles.hpp"

namespace peristat {

/// The contacts of points with rigid obstacles. They couple points that press on an obstacle which
/// a force drives.
class ObstacleTerm : public SpringTerm {
 public:
  ObstacleTerm(const Points& points, const Obstacles& obstacles)
      : SpringTerm(points), obstacles_(obstacles) {}

  /// Balances concern forces between points, of which obstacles have none.
  [[nodiscard]] Balances balances() const override { return {}; }
  /// Blocks n_i n_j^T between points with different normals are not symmetric.
  [[nodiscard]] bool has_symmetric_blocks() const override;
  [[nodiscard]] BlockCount block_count(int /*dimension*/) const override {
    return {obstacles_.coupled_pairs(), 0.0};
  }
  [[nodiscard]] double stored_bytes() const override;

  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  const Obstacles& obstacles_;
};

}  // namespace peristat
