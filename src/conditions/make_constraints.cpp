#include "src/conditions/make_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "src/conditions/linear_rows.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Orthonormal basis whose first vector is a unit normal.
std::array<Coordinates, 3> basis_of(const Coordinates& normal, int dimension) {
  if (dimension == 2) return {normal, {-normal[1], normal[0], 0.0}, {}};
  std::size_t least = 0;
  for (std::size_t c = 1; c < 3; ++c) {
    if (std::abs(normal[c]) < std::abs(normal[least])) least = c;
  }
  Coordinates axis{};
  axis[least] = 1.0;
  Coordinates first = cross(normal, axis);
  first = scaled(1.0 / length(first), first);
  return {normal, first, cross(normal, first)};
}

/// Point of a set of the whole body.
struct Member {
  Coordinates place{};
  double volume = 0.0;
  std::optional<Index> here{};  ///< the point, on ranks that have it
};

class Maker {
 public:
  Maker(const Points& points, const ConstraintSpecification& of,
        const std::vector<char>& prescribed, const std::vector<std::string>& parameters,
        const IndexMap& index_map)
      : points_(points),
        ranks_(index_map.ranks()),
        index_map_(index_map),
        of_(of),
        prescribed_(prescribed),
        parameters_(parameters),
        made_{Constraints(points, ranks_)},
        holder_(std::size_t(points.count())),
        rows_(points, prescribed, index_map) {}

  [[nodiscard]] MadeConstraints make() {
    for (std::size_t k = 0; k < of_.symmetries.size(); ++k) {
      const SymmetryPlane& plane = of_.symmetries[k];
      const SymmetryPlane* const other = opposite(of_.symmetries, k);
      made_.restraints.push_back({Restraint::Kind::symmetry,
                                  indexed("symmetries", k) + ".axis",
                                  name_of_plane(of_.symmetries, k),
                                  {},
                                  {},
                                  plane.axis,
                                  plane.at,
                                  other ? std::optional(other->at) : std::nullopt});
    }
    for (std::size_t k = 0; k < of_.periods.size(); ++k) make_period(k);
    for (std::size_t k = 0; k < of_.rigid_sets.size(); ++k) make_rigid_set(k);
    for (std::size_t k = 0; k < of_.rollers.size(); ++k) {
      of_.rollers[k].at ? make_touching_roller(k) : make_rollers(k);
    }
    for (std::size_t k = 0; k < of_.linear.size(); ++k) make_linear(k);
    rows_.eliminate(made_.constraints);
    return std::move(made_);
  }

 private:
  [[nodiscard]] int dimension() const { return points_.dimension; }
  [[nodiscard]] std::size_t dof(Index row, int component) const {
    return std::size_t(row) * std::size_t(dimension()) + std::size_t(component);
  }

  void prescribe(const std::string& key, const std::string& text, std::size_t of_dof,
                 double factor = 1.0, const Coordinates* place = nullptr) {
    try {
      Expression value(text, place ? dimension() : 0, points_.spacing, parameters_, points_.columns,
                       functions_of(points_.functions));
      made_.prescriptions.push_back(
          {key, of_dof, place ? *place : Coordinates{}, factor, std::move(value)});
    } catch (const InputError& error) {
      throw InputError(key, error.value(), error.allowed());
    }
  }

  void leave_unused(Index handle, int first) {
    for (int c = first; c < dimension(); ++c) made_.unused.push_back(dof(handle, c));
  }

  /// Records which constraint holds a point; throws if the point is held already.
  void hold(Index point, const std::string& key, const std::string& who) {
    std::string& holder = holder_[std::size_t(point)];
    for (int c = 0; c < dimension(); ++c) {
      if (holder.empty() && prescribed_[dof(point, c)]) holder = "a support";
    }
    if (!holder.empty()) {
      throw InputError(key, "",
                       who + " and " + holder + " contradict each other: both hold the point at " +
                           place_text(points_.position(point), dimension()) +
                           " m. Let only one of them hold it");
    }
    holder = who;
  }

  void make_period(std::size_t k) {
    const PeriodSpecification& period = of_.periods[k];
    const Index handle = made_.constraints.period_handle(period.axis);
    Restraint restraint{Restraint::Kind::period,
                        indexed("periods", k) + ".axis",
                        name_of_period(period),
                        {},
                        {},
                        period.axis,
                        period.from};
    restraint.length = period.to - period.from;
    for (int c = 0; c < dimension(); ++c) restraint.is_mirrored[std::size_t(c)] = is_mirrored(c);
    // Without a handle the body is farther from its images than a horizon.
    if (handle >= 0) restraint.handles.push_back(handle);
    for (int c = 0; c < dimension() && handle >= 0; ++c) {
      const auto& text = period.gradient[std::size_t(c)];
      const std::string key = indexed(indexed("periods", k) + ".gradient", std::size_t(c));
      if (is_mirrored(c) && text != "0") {
        throw InputError(key, text ? '"' + *text + '"' : "\"free\"",
                         std::string("must be 0: a plane of symmetry across ") + "xyz"[c] +
                             " allows no jump along it");
      }
      if (text) prescribe(key, *text, dof(handle, c), restraint.length);
    }
    made_.restraints.push_back(std::move(restraint));
  }

  [[nodiscard]] bool is_mirrored(int component) const {
    return std::ranges::any_of(of_.symmetries, [component](const SymmetryPlane& plane) {
      return plane.axis == component;
    });
  }

  /// Throws if a plane of symmetry cuts a set and the two halves might move apart.
  void refuse_cut_sets(const RigidSetSpecification& spec, const Constraints::RigidSet& set,
                       const std::string& table) const {
    for (const SymmetryPlane& plane : of_.symmetries) {
      const bool is_cut = std::ranges::any_of(set.members, [&](Index member) {
        const double away = points_.position(member)[std::size_t(plane.axis)] - plane.at;
        return std::abs(away) < points_.spacing.along(plane.axis);
      });
      if (!any_of_all(ranks_, is_cut)) continue;
      const std::string by = "the plane of symmetry across " + std::string(1, "xyz"[plane.axis]) +
                             " cuts the rigid set " + spec.set + ": ";
      if (!spec.displacement[std::size_t(plane.axis)]) {
        throw InputError(table + ".displacement", "\"free\"",
                         by + "along " + "xyz"[plane.axis] + " must be 0");
      }
      for (int c = 0; c < (dimension() == 3 ? 3 : 1); ++c) {
        if ((dimension() == 3 && c == plane.axis) || spec.rotation[std::size_t(c)]) continue;
        throw InputError(
            table + ".rotation", "\"free\"",
            by +
                (dimension() == 3 ? std::string("the rotation about axes other than ") +
                                        "xyz"[plane.axis] + " it"
                                  : "it") +
                " must be 0");
      }
    }
  }

  void make_rigid_set(std::size_t k) {
    const RigidSetSpecification& spec = of_.rigid_sets[k];
    const std::string table = indexed("rigid_sets", k);
    Constraints::RigidSet set;
    set.members = points_of_set(points_, spec.set, table + ".set");
    for (const Index member : set.members) {
      hold(member, table + ".set", "the rigid set " + spec.set);
    }
    set.centre = spec.centre ? *spec.centre : centre_of(members_of_all(set.members));
    set.size = size_of(set, table + ".set", spec.set);
    refuse_cut_sets(spec, set, table);
    set.translation = made_.constraints.add_handle(set.centre);
    for (int c = 0; c < dimension(); ++c) {
      const auto& text = spec.displacement[std::size_t(c)];
      const std::string key = indexed(table + ".displacement", std::size_t(c));
      if (text) prescribe(key, *text, dof(set.translation, c));
    }
    set.rotation = made_.constraints.add_handle(set.centre);
    const int rotations = dimension() == 3 ? 3 : dimension() - 1;
    for (int c = 0; c < rotations; ++c) {
      const auto& text = spec.rotation[std::size_t(c)];
      const std::string key = indexed(table + ".rotation", std::size_t(c));
      if (text) prescribe(key, *text, dof(set.rotation, c), set.size);
    }
    leave_unused(set.rotation, rotations);
    made_.restraints.push_back(
        {Restraint::Kind::rigid_set, table + ".set", spec.set, {set.translation}, {}, 0, 0.0});
    made_.constraints.follow(std::move(set));
  }

  /// Centroid, with the bits of a run on one rank, so that a run may go on with another number of
  /// ranks.
  [[nodiscard]] static Coordinates centre_of(const std::vector<Member>& members) {
    Coordinates centre{};
    double volume = 0.0;
    for (const Member& member : members) {
      centre = plus(centre, scaled(member.volume, member.place));
      volume += member.volume;
    }
    return scaled(1.0 / volume, centre);
  }

  /// Largest distance of a point from the centre; throws for a set that can turn without moving
  /// points.
  [[nodiscard]] double size_of(const Constraints::RigidSet& set, const std::string& key,
                               const std::string& name) const {
    const auto is_own = [&](Index member) { return points_.owns(member); };
    if (count_of(set.members) < 2.0) {
      throw InputError(key, '"' + name + '"',
                       "has one point, which can't turn: a rigid set needs at least two");
    }
    double size = 0.0;
    Coordinates longest{};
    for (const Index member : set.members) {
      const Coordinates arm = minus(points_.position(member), set.centre);
      if (is_own(member) && length(arm) > size) size = length(arm), longest = arm;
    }
    longest = longest_of_all(size, longest);
    size = length(longest);
    double across = 0.0;
    for (const Index member : set.members) {
      const Coordinates arm = minus(points_.position(member), set.centre);
      across = std::max(across, length(cross(longest, arm)) / size);
    }
    across = ranks_.max(across);
    constexpr double on_a_line = 1e-6;
    if (dimension() == 3 && across <= on_a_line * size) {
      throw InputError(key, '"' + name + '"',
                       "has all its points on a line through its centre: a rotation about this "
                       "line moves none of them");
    }
    return size;
  }

  /// Longest arm of all ranks, the first one of equals.
  [[nodiscard]] Coordinates longest_of_all(double size, const Coordinates& longest) const {
    const std::vector<double> all = ranks_.all_of({size, longest[0], longest[1], longest[2]});
    std::size_t first = 0;
    for (std::size_t k = 0; k < all.size(); k += 4) {
      if (all[k] > all[first]) first = k;
    }
    return {all[first + 1], all[first + 2], all[first + 3]};
  }

  [[nodiscard]] Coordinates unit_normal(const RollerSpecification& spec,
                                        const std::string& table) const {
    const double size = length(spec.normal);
    if (!(size > 0.0) || !std::isfinite(size)) {
      throw InputError(table + ".normal", place_text(spec.normal, dimension()),
                       "must be a direction, not zero");
    }
    return scaled(1.0 / size, spec.normal);
  }

  [[nodiscard]] double of_all(double mine) const { return ranks_.sum(mine); }

  /// Number of points of a set of the whole body.
  [[nodiscard]] double count_of(const std::vector<Index>& members) const {
    return of_all(
        double(std::ranges::count_if(members, [&](Index member) { return points_.owns(member); })));
  }

  /// Points of a set of the whole body, the same on all ranks and in the order of a run on one
  /// rank.
  [[nodiscard]] std::vector<Member> members_of_all(const std::vector<Index>& members) const {
    std::vector<Member> all;
    std::vector<double> told;  // numbers, places and volumes
    for (const Index member : members) {
      if (!points_.owns(member)) continue;
      const Coordinates at = points_.position(member);
      told.push_back(double(index_map_.number_of(member)));
      told.insert(told.end(), at.begin(), at.end());
      told.push_back(points_.volume[std::size_t(member)]);
    }
    told = concatenated(ranks_, told);
    std::map<GlobalIndex, Member> by_number;
    for (std::size_t k = 0; k < told.size(); k += 5) {
      const auto number = GlobalIndex(told[k]);
      by_number[number] = {
          {told[k + 1], told[k + 2], told[k + 3]}, told[k + 4], index_map_.find(number)};
    }
    for (const auto& [number, member] : by_number) all.push_back(member);
    return all;
  }

  void make_rollers(std::size_t k) {
    const RollerSpecification& spec = of_.rollers[k];
    const std::string table = indexed("rollers", k);
    const std::array<Coordinates, 3> basis = basis_of(unit_normal(spec, table), dimension());
    Restraint restraint{
        Restraint::Kind::rollers, table + ".set", spec.name(), {}, basis[0], 0, 0.0};
    const std::vector<Index>& members = points_of_set(points_, spec.set, table + ".set");
    for (const Index member : members) {
      hold(member, table + ".set", "the roller of set " + spec.set);
    }
    const std::vector<Member> all = members_of_all(members);
    Index common = -1;
    const bool is_free = spec.displacement == "free";
    if (is_free) {
      common = made_.constraints.add_handle(centre_of(all));
      leave_unused(common, 1);
      restraint.handles.push_back(common);
    }
    for (const Member& member : all) {
      const Index own = made_.constraints.add_handle(member.place);
      if (!is_free) {
        prescribe(table + ".displacement", spec.displacement, dof(own, 0), 1.0, &member.place);
        restraint.handles.push_back(own);
      } else {
        made_.unused.push_back(dof(own, 0));
      }
      hold_along(basis[0], member, is_free ? &all.front() : nullptr);
      if (member.here) slide(*member.here, basis, own, common);
    }
    made_.restraints.push_back(std::move(restraint));
  }

  /// Records that a point is held along a normal, relative to another point if there is one.
  void hold_along(const Coordinates& normal, const Member& member, const Member* against) {
    if (&member == against) return;
    HeldSum held;
    const auto add = [&](const Member& of, double weight) {
      if (of.here && points_.owns(*of.here)) held.emplace_back(*of.here, scaled(weight, normal));
    };
    add(member, 1.0);
    if (against) add(*against, -1.0);
    made_.held_sums.push_back(std::move(held));
  }

  /// Makes a point follow its own handle and, along the normal, the common one if there is one.
  void slide(Index member, const std::array<Coordinates, 3>& basis, Index own, Index common) {
    for (int c = 1; c < dimension(); ++c) {
      made_.slides.push_back({dof(own, c), member, basis[std::size_t(c)]});
    }
    std::vector<Dependence> masters{{own, {}}};
    if (common >= 0) masters.push_back({common, {}});
    for (std::size_t r = 0; r < std::size_t(dimension()); ++r) {
      for (std::size_t c = 0; c < std::size_t(dimension()); ++c) {
        masters.front().block[r][c] = basis[c][r];
      }
      if (common >= 0) masters.back().block[r][0] = basis[0][r];
    }
    made_.constraints.follow(member, {true, true, true}, std::move(masters));
  }

  /// A roller that touches the body at a place or along a line: it holds the normal displacement of
  /// the place, interpolated between the nearest points.
  void make_touching_roller(std::size_t k) {
    const RollerSpecification& spec = of_.rollers[k];
    const std::string table = indexed("rollers", k);
    const std::array<Coordinates, 3> basis = basis_of(unit_normal(spec, table), dimension());
    Restraint restraint{
        Restraint::Kind::rollers, table + ".set", spec.name(), {}, basis[0], 0, 0.0};
    const Coordinates along = spec.to ? minus(*spec.to, *spec.at) : Coordinates{};
    const int stations =
        std::max(1, static_cast<int>(std::lround(length(along) / points_.spacing)));
    for (int station = 0; station < stations; ++station) {
      const double share = spec.to ? (station + 0.5) / stations : 0.0;
      const Coordinates place = plus(*spec.at, scaled(share, along));
      const Index value = made_.constraints.add_handle(place);
      leave_unused(value, 1);
      prescribe(table + ".displacement", spec.displacement, dof(value, 0), 1.0, &place);
      restraint.handles.push_back(value);
      HeldSum held;
      LinearRow row{table + ".at", "the roller " + spec.name(), {}, dof(value, 0)};
      for (const auto& [point, weight] : nearest(place, basis, table)) {
        for (int c = 0; c < dimension(); ++c) {
          row.add(dof(point, c), weight * basis[0][std::size_t(c)]);
        }
        refuse_follower(point, table + ".at", "the roller " + spec.name());
        held.emplace_back(point, scaled(weight, basis[0]));
      }
      made_.held_sums.push_back(std::move(held));
      rows_.push_back(std::move(row));
    }
    made_.restraints.push_back(std::move(restraint));
  }

  /// Points of the row at a place, with hat functions as weights, which reproduce linear fields.
  /// For a part of a body those that this rank owns.
  [[nodiscard]] std::vector<std::pair<Index, double>> nearest(
      const Coordinates& place, const std::array<Coordinates, 3>& basis,
      const std::string& table) const {
    const double reach = points_.spacing;
    std::vector<std::pair<Index, double>> found;
    std::vector<double> depth;
    double least = std::numeric_limits<double>::infinity(), sum = 0.0;
    for (Index i = 0; i < points_.owned.value_or(points_.own()); ++i) {
      const Coordinates arm = minus(points_.position(i), place);
      double weight = 1.0;
      for (int c = 1; c < dimension(); ++c) {
        weight *= 1.0 - std::abs(dot(arm, basis[std::size_t(c)])) / reach;
        if (weight <= 1e-9) break;
      }
      const double across = std::abs(dot(arm, basis[0]));
      if (weight <= 1e-9 || across > 2.0 * reach) continue;
      found.emplace_back(i, weight);
      depth.push_back(across);
      least = std::min(least, across);
    }
    least = ranks_.min(least);
    std::vector<std::pair<Index, double>> row;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (depth[k] > least + 0.5 * reach) continue;
      row.push_back(found[k]);
      sum += found[k].second;
    }
    sum = of_all(sum);
    if (sum == 0.0) {
      throw InputError(table + ".at", place_text(place, dimension()),
                       "no points of the body are within two spacings of this place");
    }
    for (auto& [point, weight] : row) weight /= sum;
    return row;
  }

  void refuse_follower(Index point, const std::string& key, const std::string& who) const {
    const std::string& holder = holder_[std::size_t(point)];
    if (holder.empty()) return;
    throw InputError(key, "",
                     who + " and " + holder +
                         " contradict each other: both hold the "
                         "point at " +
                         place_text(points_.position(point), dimension()) + " m");
  }

  void make_linear(std::size_t k) {
    const LinearConstraintSpecification& spec = of_.linear[k];
    const std::string table = indexed("linear", k);
    Restraint restraint{Restraint::Kind::linear, table + ".name", spec.name, {}, {}, 0, 0.0};
    const Index value = made_.constraints.add_handle({});
    leave_unused(value, 1);
    prescribe(table + ".displacement", spec.displacement, dof(value, 0));
    restraint.handles.push_back(value);
    LinearRow row{table, "the linear constraint " + spec.name, {}, dof(value, 0)};
    HeldSum held;
    for (std::size_t t = 0; t < spec.terms.size(); ++t) {
      const ControlTerm& term = spec.terms[t];
      const std::string key = indexed(table + ".term", t);
      const std::vector<Index>& members = points_of_set(points_, term.set, key + ".set");
      const double count = count_of(members);
      for (const Index member : members) {
        refuse_follower(member, key + ".set", "the linear constraint " + spec.name);
        if (!points_.owns(member)) continue;
        for (int c = 0; c < dimension(); ++c) {
          row.add(dof(member, c), term.weights[std::size_t(c)] / count);
        }
        held.emplace_back(member, scaled(1.0 / count, term.weights));
      }
    }
    made_.held_sums.push_back(std::move(held));
    rows_.push_back(std::move(row));
    made_.restraints.push_back(std::move(restraint));
  }

  const Points& points_;
  const Communicator& ranks_;
  const IndexMap& index_map_;
  const ConstraintSpecification& of_;
  const std::vector<char>& prescribed_;
  const std::vector<std::string>& parameters_;
  MadeConstraints made_;
  std::vector<std::string> holder_;  // rigid set or rollers that hold each point; empty: none
  LinearRows rows_;
};

}  // namespace

MadeConstraints make_constraints(const Points& points, const ConstraintSpecification& of,
                                 const std::vector<char>& prescribed,
                                 const std::vector<std::string>& parameters,
                                 const IndexMap& index_map) {
  return Maker(points, of, prescribed, parameters, index_map).make();
}

}  // namespace peristat
