#include "solvers/formulations/specification/check_contacts.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "solvers/formulations/specification/require.hpp"
#include "src/conditions/points_of_set.hpp"

namespace peristat {
namespace {

/// Points of a set, ascending; all without a name.
std::vector<Index> points_that_touch(const Points& points, const std::string& set,
                                     const std::string& key) {
  if (!set.empty()) return points_of_set(points, set, key);
  std::vector<Index> all(std::size_t(points.count()));
  for (Index i = 0; i < points.count(); ++i) all[std::size_t(i)] = i;
  return all;
}

bool have_a_common_point(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> common;
  std::ranges::set_intersection(a, b, std::back_inserter(common));
  return !common.empty();
}

struct Sides {
  std::vector<Index> one, other;
};

}  // namespace

void check_contacts(const BodySpecification& of, const Points& points) {
  std::vector<Sides> before;
  for (std::size_t k = 0; k < of.contacts.size(); ++k) {
    const ContactSpecification& contact = of.contacts[k];
    const std::string table = indexed("contacts", k);
    require_within(contact.stiffness, 1e-3, 1e3, table + ".stiffness");
    require_within(contact.depth, 0.01, 0.5, table + ".depth");
    require(contact.softness >= 1e-9 && contact.softness <= 0.5 * contact.depth,
            table + ".softness", number_text(contact.softness),
            "must be from 1e-9 to half of the depth, " + number_text(0.5 * contact.depth));
    require(contact.distance >= 0.0 && contact.distance <= of.horizon, table + ".distance",
            number_text(contact.distance),
            "must be positive and no longer than the horizon, " + number_text(of.horizon) + " m");
    require(contact.shape == ContactShape::points || points.dimension > 1, table + ".shape",
            "\"faces\"", "needs two or three dimensions; a bar has points alone");
    require_within(contact.friction, 0.0, 1000.0, table + ".friction");
    require_within(contact.tangential_stiffness, 0.001, 1000.0, table + ".tangential_stiffness");
    const bool has_images = !of.constraints.symmetries.empty() || !of.constraints.periods.empty();
    require(!has_images || contact.shape == ContactShape::points, table + ".shape", "\"faces\"",
            "is not for bodies with planes of symmetry and periods, beyond which faces do not see "
            "one another; take \"points\" or the whole body");
    require(!has_images || contact.friction == 0.0, table + ".friction",
            number_text(contact.friction),
            "is not for bodies with planes of symmetry and periods; take the whole body");
    require_absent(!contact.with.empty() && contact.set.empty(), table + ".with",
                   "needs the other set, " + table + ".set");
    Sides sides{points_that_touch(points, contact.set, table + ".set"), {}};
    if (!contact.with.empty()) {
      sides.other = points_that_touch(points, contact.with, table + ".with");
      require(!have_a_common_point(sides.one, sides.other), table + ".with",
              '"' + contact.with + '"',
              "shares points with set \"" + contact.set +
                  "\"; give two sets without common points, or one set for contact within it");
    } else {
      sides.other = sides.one;
    }
    for (const Sides& earlier : before) {
      const bool overlaps = (have_a_common_point(sides.one, earlier.one) &&
                             have_a_common_point(sides.other, earlier.other)) ||
                            (have_a_common_point(sides.one, earlier.other) &&
                             have_a_common_point(sides.other, earlier.one));
      require(!overlaps, table, "", "has pairs of points in common with another contact");
    }
    before.push_back(std::move(sides));
  }
}

}  // namespace peristat
