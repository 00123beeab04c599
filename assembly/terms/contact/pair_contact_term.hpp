#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/contact/contact_pairs.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// Contact of points that no whole bond joins: with x = (d - r) / (a d), r their distance,
///
///   E = sum (1 - T) k (a d)^2 b(x)
///
/// over pairs, b the ContactLaw and T the integrity of the bond between them, 0 without one: what a
/// bond loses its contact takes over, and a bond loses it only where r > d. Forces are central.
class PairContactTerm : public Term {
 public:
  explicit PairContactTerm(ContactPairs pairs)
      : pairs_(std::move(pairs)), no_couplings_(std::size_t(pairs_.points().count()) + 1, 0) {}

  [[nodiscard]] const ContactPairs& pairs() const { return pairs_; }

  [[nodiscard]] Couplings couplings() const override { return {no_couplings_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] Balances balances() const override { return {}; }
  [[nodiscard]] double stored_bytes() const override { return pairs_.bytes(); }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  ContactPairs pairs_;
  std::vector<Offset> no_couplings_;
};

}  // namespace peristat
