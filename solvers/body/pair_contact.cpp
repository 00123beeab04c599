#include "solvers/body/pair_contact.hpp"

#include <utility>
#include <vector>

#include "assembly/terms/contact/pair_contact_term.hpp"
#include "solvers/body/youngs_moduli.hpp"
#include "src/geometry/point_sizes.hpp"

namespace peristat {
namespace {

PairContactRule rule_of(const ContactSpecification& of, const Points& points) {
  PairContactRule rule{.law = {of.softness / of.depth},
                       .depth = of.depth,
                       .stiffness = of.stiffness,
                       .distance = of.distance,
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

std::shared_ptr<Term> make_pair_contact(const Body& body) {
  const BodySpecification& of = body.specification;
  if (of.contacts.empty()) return nullptr;
  const Points& points = body.points;
  std::vector<PairContactRule> rules;
  for (const ContactSpecification& contact : of.contacts) rules.push_back(rule_of(contact, points));
  std::vector<double> size;
  for (Index i = 0; i < points.count(); ++i) {
    size.push_back(size_of_point(points, i, body.setting.cross_section));
  }
  return std::make_shared<PairContactTerm>(
      ContactPairs(points, body.model.bonds(), std::move(rules), std::move(size),
                   youngs_moduli(body), body.model.failing_bonds() != nullptr));
}

}  // namespace peristat
