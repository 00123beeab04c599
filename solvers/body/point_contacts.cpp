#include "solvers/body/point_contacts.hpp"

#include <utility>
#include <vector>

#include "assembly/terms/contact/face_contact_term.hpp"
#include "assembly/terms/contact/pair_contact_term.hpp"
#include "solvers/body/youngs_moduli.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/point_sizes.hpp"

namespace peristat {
namespace {

PairContactRule rule_of(const ContactSpecification& of, const Points& points) {
  PairContactRule rule{.law = {of.softness / of.depth},
                       .depth = of.depth,
                       .stiffness = of.stiffness,
                       .distance = of.distance,
                       .has_faces = of.shape == ContactShape::faces,
                       .friction = of.friction,
                       .tangential = of.tangential_stiffness,
                       .side = {},
                       .has_two_sides = !of.with.empty()};
  if (of.set.empty()) return rule;
  rule.side.assign(std::size_t(points.count()), 0);
  for (const Index point : points.sets.at(of.set)) rule.side[std::size_t(point)] = 1;
  if (!of.with.empty()) {
    for (const Index point : points.sets.at(of.with)) rule.side[std::size_t(point)] = 2;
  }
  for (Index image = points.own(); image < points.count(); ++image) {
    rule.side[std::size_t(image)] = rule.side[std::size_t(points.source(image))];
  }
  return rule;
}

}  // namespace

void add_contacts(const Body& body, Model& model) {
  const BodySpecification& of = body.specification;
  if (of.contacts.empty()) return;
  const Points& points = body.points;
  std::vector<PairContactRule> rules;
  for (const ContactSpecification& contact : of.contacts) rules.push_back(rule_of(contact, points));
  std::vector<double> size;
  for (Index i = 0; i < points.count(); ++i) {
    size.push_back(size_of_point(points, i, body.setting.cross_section));
  }
  const Bonds& bonds = body.model.bonds();
  auto contacts = std::make_shared<const PointContacts>(
      ContactPairs(points, bonds, std::move(rules), std::move(size), youngs_moduli(body),
                   body.setting.cross_section, body.model.failing_bonds() != nullptr,
                   body.index_map->ranks()),
      bonds);
  for (std::size_t k = 0; k < of.contacts.size(); ++k) {
    if (of.contacts[k].shape == ContactShape::points || !contacts->faces.none()) continue;
    throw InputError(
        indexed("contacts", k) + ".shape", "\"faces\"",
        "finds no faces: the body is one point thick, or bonds do not reach across the "
        "diagonals of its cells; take \"points\"");
  }
  model.add(std::make_shared<PairContactTerm>(contacts));
  if (!contacts->faces.none()) model.add(std::make_shared<FaceContactTerm>(contacts));
}

}  // namespace peristat
