#pragma once

#include <memory>
#include <vector>

#include "assembly/terms/contact/point_contacts.hpp"
#include "assembly/terms/term.hpp"

namespace peristat {

/// Contact of surface points with facets of the body: with the parts F of the surface that a point
/// is near, their coefficients c_F (ContactFaces), and x_F = (d - r_F) / (a d), r_F the distance
/// of the point from the closed part,
///
///   E = sum over points of k (a d)^2 sum_F c_F b(x_F),   k = alpha E A / (2 d),
///
/// b the ContactLaw. Each of two surfaces that touch has a half. Forces on a facet are shared out
/// to its corners by the place that is pressed, so that sums and moments of all forces vanish.
class FaceContactTerm : public Term {
 public:
  explicit FaceContactTerm(std::shared_ptr<const PointContacts> contacts)
      : contacts_(std::move(contacts)),
        no_couplings_(std::size_t(contacts_->pairs.points().count()) + 1, 0) {}

  [[nodiscard]] const PointContacts& contacts() const { return *contacts_; }

  [[nodiscard]] Couplings couplings() const override { return {no_couplings_, {}}; }
  [[nodiscard]] Balances balances() const override { return contacts_->balances(); }
  [[nodiscard]] double stored_bytes() const override { return contacts_->faces.bytes(); }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  std::shared_ptr<const PointContacts> contacts_;
  std::vector<Offset> no_couplings_;
};

/// Tears the facets along whose sides bonds have lost more than half of their integrity, as a
/// commit does. Returns true if there are some: the forces of contacts change with them.
bool tear_faces(const Model& model, History& history);

}  // namespace peristat
