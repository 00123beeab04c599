#pragma once

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/contact/face_contact_term.hpp"
#include "assembly/terms/contact/pair_contact_term.hpp"
#include "src/core/coordinates.hpp"
#include "tests/bodies.hpp"

namespace peristat::tests {

inline constexpr double spacing = 0.1, modulus = 3.0;

/// Two halves of a box without a bond between them, beside one another along the last axis.
struct Halves {
  BoxBody body;
  std::shared_ptr<const PointContacts> contacts;
  std::shared_ptr<PairContactTerm> contact;

  explicit Halves(int dimension, const PairContactRule& rule = {}, bool fails = false)
      : body(setting_of(dimension, fails)) {
    if (!fails) {
      body.remove_bonds([&](Index i, Offset bond) {
        return is_above(i) != is_above(body.model.bonds().partner(i, bond));
      });
    }
    const auto count = std::size_t(body.points.count());
    contacts = std::make_shared<const PointContacts>(
        ContactPairs(body.points, body.model.bonds(), {rule}, std::vector<double>(count, spacing),
                     std::vector<double>(count, modulus), body.points.cross_section(), fails),
        body.model.bonds());
    contact = std::make_shared<PairContactTerm>(contacts);
    add_to(body.model);
  }

  static BoxSetting setting_of(int dimension, bool fails) {
    BoxSetting box = tests::small_box(dimension);
    if (dimension == 2) box.extent = {9, 8, 0};
    if (dimension == 3) box.extent = {4, 4, 6};
    if (dimension == 1) box.extent = {12, 0, 0};
    box.horizon_ratio = 2.015;
    if (fails) {
      box.potential = [](double micromodulus) -> BondPotential {
        return Degraded<CriticalStretch>{micromodulus, {0.01}};
      };
    }
    return box;
  }

  void add_to(Model& model) const {
    model.add(contact);
    if (!contacts->faces.none()) model.add(std::make_shared<FaceContactTerm>(contacts));
  }
  /// The contacts without the bonds' energy.
  [[nodiscard]] Model alone() const {
    Model model(body.model.bonds());
    add_to(model);
    return model;
  }
  [[nodiscard]] int dimension() const { return body.points.dimension; }
  [[nodiscard]] bool is_above(Index i) const {
    const double middle = dimension() == 2 ? 0.4 : dimension() == 3 ? 0.3 : 0.6;
    return body.points.position(i)[std::size_t(dimension() - 1)] > middle;
  }
  /// The upper half moves by this along the last axis and along the first, and all points a little.
  [[nodiscard]] std::vector<double> moved(double along, double aside, double noise) const {
    std::vector<double> displacement = Random(3).vector(body.dofs(), noise * spacing);
    const auto d = std::size_t(dimension());
    for (Index i = 0; i < body.points.count(); ++i) {
      if (!is_above(i)) continue;
      displacement[std::size_t(i) * d] += aside * spacing;
      displacement[std::size_t(i) * d + d - 1] += along * spacing;
    }
    return displacement;
  }
  [[nodiscard]] std::vector<double> pressed() const {
    return moved(-0.12, dimension() == 1 ? 0.0 : 0.05, 0.02);
  }
};

inline std::vector<double> gradient_at(Assembler& assembler,
                                       const std::vector<double>& displacement) {
  std::vector<double> gradient(displacement.size());
  static_cast<void>(assembler.gradient(displacement, gradient));
  return gradient;
}

/// Expects forces whose sum and moment about the origin vanish.
inline void expect_balance(const Halves& halves, const std::vector<double>& at,
                           const std::vector<double>& gradient) {
  const auto d = std::size_t(halves.dimension());
  Coordinates force{}, moment{};
  for (Index i = 0; i < halves.body.points.count(); ++i) {
    Coordinates place = halves.body.points.position(i), here{};
    for (std::size_t c = 0; c < d; ++c) {
      place[c] += at[std::size_t(i) * d + c];
      here[c] = gradient[std::size_t(i) * d + c];
    }
    force = plus(force, here);
    moment = plus(moment, cross(place, here));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(force[c], 0.0, 1e-13 * norm(gradient));
    EXPECT_NEAR(moment[c], 0.0, 1e-13 * norm(gradient));
  }
}

}  // namespace peristat::tests
