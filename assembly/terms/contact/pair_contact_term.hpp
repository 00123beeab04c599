#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/contact/point_contacts.hpp"
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
  explicit PairContactTerm(std::shared_ptr<const PointContacts> contacts)
      : contacts_(std::move(contacts)),
        no_couplings_(std::size_t(contacts_->pairs.points().count()) + 1, 0) {}

  [[nodiscard]] const PointContacts& contacts() const { return *contacts_; }

  [[nodiscard]] Couplings couplings() const override { return {no_couplings_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] Balances balances() const override { return contacts_->balances(); }
  [[nodiscard]] double stored_bytes() const override { return contacts_->pairs.bytes(); }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const PointContacts> contacts_;
  std::vector<Offset> no_couplings_;
};

}  // namespace peristat
