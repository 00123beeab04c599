#pragma once

#include <cstddef>
#include <vector>

#include "assembly/terms/term.hpp"

namespace peristat {

/// Springs from points to given positions, which couple no points: the common base of their kinds.
class SpringTerm : public Term {
 public:
  explicit SpringTerm(const Points& points) : offset_(std::size_t(points.count()) + 1, 0) {}

  [[nodiscard]] Couplings couplings() const override { return {offset_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  /// Balances concern forces between points, of which springs have none.
  [[nodiscard]] Balances balances() const override { return {.linear = true}; }
  [[nodiscard]] double stored_bytes() const override {
    return double(offset_.size() * sizeof(Offset));
  }

 private:
  std::vector<Offset> offset_;
};

}  // namespace peristat
