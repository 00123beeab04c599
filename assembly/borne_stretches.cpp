#include "assembly/borne_stretches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "assembly/terms/bonds/bond_look.hpp"
#include "assembly/terms/bonds/stretches_along.hpp"
#include "assembly/terms/damage.hpp"
#include "src/core/threads.hpp"

namespace peristat {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Calls visit(law) if the bonds can be damaged; law.of_bond(bond) is that of one of them.
template <class Visit>
void with_law(const Model& model, const History& history, const Visit& visit) {
  if (const BondFailure* const bonds = model.failing_bonds()) {
    bonds->with_damage_law(model.failure_history(history), visit);
  }
}

/// Current unit vector along the bond between two points.
Coordinates direction(const Points& points, const StateView& at, Index i, Index j) {
  const std::size_t d = std::size_t(points.dimension);
  Coordinates arm{};
  for (std::size_t c = 0; c < d; ++c) {
    const std::size_t from = std::size_t(i) * d + c, to = std::size_t(j) * d + c;
    arm[c] =
        points.reference[to] - points.reference[from] + at.displacement[to] - at.displacement[from];
  }
  const double length = std::hypot(arm[0], arm[1], arm[2]);
  for (double& component : arm) component /= length;
  return arm;
}

double driving(const BondStretch& stretch) { return stretch.value; }
double driving(const BondDrive& drive) { return drive.driving(); }

/// Narrows a range to the steps in which a bond keeps to a limit. Divides only where it does: of
/// the many bonds few are the first to meet theirs.
void narrow(AdmissibleRange& range, const BondStretch& stretch, double limit) {
  const double left = limit - stretch.value;
  if (stretch.rate > 0.0 && left < range.high * stretch.rate) range.high = left / stretch.rate;
  if (stretch.rate < 0.0 && left < range.low * stretch.rate) range.low = left / stretch.rate;
}

void narrow(AdmissibleRange& range, const AdmissibleRange& by) {
  range.low = std::max(range.low, by.low);
  range.high = std::min(range.high, by.high);
  range.utilisation = std::max(range.utilisation, by.utilisation);
}

void narrow(AdmissibleRange& range, const BondDrive& drive, double limit) {
  narrow(range, admissible_range(drive, limit));
}

/// Raises the utilisation to that of a bond, if it has a larger one.
void raise(double& utilisation, double stretch, double borne) {
  if (stretch > utilisation * borne) utilisation = stretch / borne;
}

/// Calls visit(thread, point, bond) for every bond with a finite borne stretch, on several threads;
/// each thread visits consecutive bonds.
template <class Visit>
void for_each_bearing(const Assembler& body, std::span<const double> borne, const Visit& visit) {
  const Bonds& bonds = body.model().bonds();
  run_on_threads(body.threads(), [&](int thread) {
    const std::ptrdiff_t count = bonds.points();
    const Index first = Index(count * thread / body.threads());
    const Index last = Index(count * (thread + 1) / body.threads());
    for (Index i = first; i < last; ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        if (borne[std::size_t(bond)] < infinite) visit(thread, i, bond);
      }
    }
  });
}

/// Calls visit(look) with the kinematics of the bonds.
template <class Visit>
void look_at_bonds(const Assembler& body, const StateView& at, const Visit& visit) {
  const Bonds& bonds = body.model().bonds();
  switch (body.points().dimension) {
    case 1:
      return visit(BondLook<1>(body.points(), bonds, at));
    case 2:
      return visit(BondLook<2>(body.points(), bonds, at));
    default:
      return visit(BondLook<3>(body.points(), bonds, at));
  }
}

std::vector<BondDrive> drives(Assembler& body, const StateView& at, const StateLine& line) {
  std::vector<BondDrive> all =
      stretches_along(body.points(), body.model().bonds(), at, line, body.threads());
  body.add_drive(at, line, all);
  return all;
}

/// Calls visit(thread, point, bond, drive) for every bond with a finite borne stretch, drive a
/// BondStretch or a BondDrive.
/// @param among these bonds; empty for all
template <class Visit>
void for_each_driven(Assembler& body, const StateView& at, std::span<const double> borne,
                     const StateLine& line, const Visit& visit,
                     std::span<const UtilisedBond> among = {}) {
  const auto for_each = [&](const auto& visit_bond) {
    if (among.empty()) return for_each_bearing(body, borne, visit_bond);
    for (const UtilisedBond& one : among) visit_bond(0, one.first_point, one.bond);
  };
  if (body.model().fails_by_release()) {
    const std::vector<BondDrive> all = drives(body, at, line);
    for_each(
        [&](int thread, Index i, Offset bond) { visit(thread, i, bond, all[std::size_t(bond)]); });
    return;
  }
  look_at_bonds(body, at, [&](const auto& look) {
    for_each([&](int thread, Index i, Offset bond) {
      visit(thread, i, bond, look.along(i, bond, line));
    });
  });
}

/// Roots of a x^2 + b x + c, without cancellation; those that are not finite are none.
std::array<double, 2> roots(double a, double b, double c) {
  const double root = std::sqrt(b * b - 4.0 * a * c);  // NaN: no roots
  const double q = -0.5 * (b + std::copysign(root, b));
  return {q / a, c / q};
}

}  // namespace

std::vector<double> borne_stretches(const Model& model, const History& history) {
  const std::span<const double> largest = bond_stretches(model, history);
  std::vector<double> borne(largest.size());
  with_law(model, history, [&](const auto& laws) {
    for (std::size_t bond = 0; bond < borne.size(); ++bond) {
      borne[bond] = model.bonds().weight(Offset(bond)) == 0.0
                        ? infinite
                        : laws.of_bond(Offset(bond)).borne(largest[bond]);
    }
  });
  return borne;
}

bool fails_by_steps(const Model& model) {
  const BondFailure* const bonds = model.failing_bonds();
  if (bonds == nullptr) return false;
  bool all = true;
  const std::vector<double> history = bonds->initial_history();
  bonds->with_damage_law(history, [&](const auto& laws) {
    for (Offset bond = 0; all && bond < model.bonds().count(); ++bond) {
      all = falls_by_steps(laws.of_bond(bond).law);
    }
  });
  return all;
}

AdmissibleRange admissible_range(const BondDrive& drive, double limit) {
  const auto& [stretch, speed, squared] = drive;
  const double above = squared[0] - limit * limit;
  const auto [one, other] = roots(squared[2], squared[1], above);
  // Between two of these steps the bond is either within its limit or beyond it.
  std::array<double, 5> ends{-infinite, one, other, -stretch / speed, infinite};
  for (double& end : ends) end = std::isnan(end) ? infinite : end;
  std::ranges::sort(ends);
  const auto is_beyond = [&](double step) {
    return stretch + step * speed > 0.0 && above + step * (squared[1] + step * squared[2]) > 0.0;
  };
  const auto within = [](double low, double high) {
    if (std::isinf(low)) return std::isinf(high) ? 0.0 : high - 1.0 - std::abs(high);
    return std::isinf(high) ? low + 1.0 + std::abs(low) : 0.5 * (low + high);
  };
  const bool starts_beyond = is_beyond(0.0);
  double previous = -infinite, next = infinite;  // the nearest ends at which that changes
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    if (!(ends[k] < ends[k + 1])) continue;
    if (is_beyond(within(ends[k], ends[k + 1])) == starts_beyond) continue;
    if (ends[k] >= 0.0) next = std::min(next, ends[k]);
    if (ends[k + 1] <= 0.0) previous = ends[k + 1];
  }
  if (!starts_beyond) return {previous, next};
  const bool goes_down = std::isinf(next) || (squared[1] > 0.0 && !std::isinf(previous));
  return goes_down ? AdmissibleRange{-infinite, previous} : AdmissibleRange{next, infinite};
}

BondDrops drop(Assembler& body, const StateView& at, std::span<const double> borne,
               std::span<const UtilisedBond> bonds) {
  const Model& model = body.model();
  const std::span<const double> before = bond_stretches(model, at.history);
  BondDrops result{{before.begin(), before.end()}, {borne.begin(), borne.end()}};
  const Bonds& network = model.bonds();
  const bool is_by_release = model.fails_by_release();
  with_law(model, at.history, [&](const auto& laws) {
    for (const UtilisedBond& one : bonds) {
      const Offset bond = one.bond;
      const auto law = laws.of_bond(bond);
      double& largest = result.histories[std::size_t(bond)];
      const double after = borne_after(law.law, law.borne(largest));
      const double volume = network.weight(bond) * network.length(bond);
      const auto whole = [&](double kappa) {
        auto potential = law.shape;
        potential.modulus = law.modulus * law.integrity_after(kappa);
        return potential(one.stretch);
      };
      const auto stored = whole(largest), left = whole(after);
      result.dissipated += volume * (law.dissipated(after) - law.dissipated(largest));
      if (!is_by_release) {
        result.energy_lost += volume * (stored.value - left.value);
        const Index second = network.partner(one.first_point, bond);
        result.stiffness.push_back(
            {bond, one.first_point, second, direction(body.points(), at, one.first_point, second),
             (stored.second - left.second) * network.weight(bond) * network.inverse_length(bond),
             (stored.first - left.first) * network.weight(bond)});
      }
      largest = after;
      result.borne[std::size_t(bond)] = law.borne(after);
      result.breaking += law.is_broken(after);
    }
  });
  if (is_by_release) {
    const History after = body.history_of(result.histories, at.history);
    result.energy_lost = body.energy(at).energy -
                         body.energy({at.displacement, after, at.damage, at.environment}).energy;
  }
  return result;
}

std::vector<UtilisedBond> utilised_bonds(Assembler& body, const StateView& at,
                                         std::span<const double> borne, double least) {
  std::vector<std::vector<UtilisedBond>> parts(static_cast<std::size_t>(body.threads()));
  for_each_driven(body, at, borne, {}, [&](int thread, Index i, Offset bond, const auto& drive) {
    const double stretch = driving(drive), strength = borne[std::size_t(bond)];
    if (!(stretch >= least * strength)) return;  // nor one that is not a number
    parts[std::size_t(thread)].push_back({bond, i, stretch / strength, stretch});
  });
  std::vector<UtilisedBond> found;
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::ranges::sort(found, [](const UtilisedBond& a, const UtilisedBond& b) {
    return std::tuple(-a.utilisation, a.bond) < std::tuple(-b.utilisation, b.bond);
  });
  return found;
}

AdmissibleRange admissible_range(Assembler& body, const StateView& at,
                                 std::span<const double> borne, std::span<const double> rate,
                                 std::span<const double> eigenstretch_rate, double share,
                                 std::span<const UtilisedBond> among) {
  std::vector<AdmissibleRange> parts(static_cast<std::size_t>(body.threads()));
  for_each_driven(
      body, at, borne, {rate, eigenstretch_rate},
      [&](int thread, Index, Offset bond, const auto& drive) {
        const double strength = borne[std::size_t(bond)];
        AdmissibleRange& part = parts[std::size_t(thread)];
        narrow(part, drive, share * strength);
        raise(part.utilisation, driving(drive), strength);
      },
      among);
  AdmissibleRange range;
  for (const AdmissibleRange& part : parts) narrow(range, part);
  return range;
}

double largest_utilisation(Assembler& body, const StateView& at, std::span<const double> borne) {
  std::vector<double> parts(static_cast<std::size_t>(body.threads()), 0.0);
  for_each_driven(body, at, borne, {}, [&](int thread, Index, Offset bond, const auto& drive) {
    raise(parts[std::size_t(thread)], driving(drive), borne[std::size_t(bond)]);
  });
  return *std::ranges::max_element(parts);
}

}  // namespace peristat
