#pragma once

#include <algorithm>
#include <utility>

#include "assembly/terms/balances.hpp"
#include "assembly/terms/contact/contact_faces.hpp"
#include "assembly/terms/contact/contact_pairs.hpp"

namespace peristat {

/// What touches in a body: pairs of points, and points and facets.
struct PointContacts {
  PointContacts(ContactPairs of, const Bonds& bonds) : pairs(std::move(of)), faces(pairs, bonds) {}
  PointContacts(const PointContacts&) = delete;  // the faces refer to the pairs
  PointContacts& operator=(const PointContacts&) = delete;

  ContactPairs pairs;
  ContactFaces faces;

  /// Friction between points at a distance is a couple, which points without rotation don't bear.
  [[nodiscard]] Balances balances() const {
    return {.moment_sum = std::ranges::none_of(
                pairs.rules(), [](const auto& rule) { return rule.friction > 0.0; })};
  }
};

}  // namespace peristat
