#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/term.hpp"
#include "src/conditions/foundations.hpp"

namespace peristat {

/// The springs of elastic foundations: k (u - g)^2 / 2 per component. Couples no points.
class FoundationTerm : public Term {
 public:
  FoundationTerm(const Points& points, const Foundations& foundations)
      : points_(points), foundations_(foundations), offset_(std::size_t(points.count()) + 1, 0) {}

  [[nodiscard]] Couplings couplings() const override { return {offset_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  /// Of the points among one another, where it has no force.
  [[nodiscard]] Balances balances() const override { return {}; }
  [[nodiscard]] double stored_bytes() const override {
    return double(offset_.size() * sizeof(Offset));
  }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

  [[nodiscard]] const Foundations& foundations() const { return foundations_; }

 private:
  const Points& points_;
  const Foundations& foundations_;
  std::vector<Offset> offset_;
};

}  // namespace peristat
