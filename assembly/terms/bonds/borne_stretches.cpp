#include "assembly/terms/bonds/borne_stretches.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "assembly/terms/bonds/bond_look.hpp"
#include "assembly/terms/damage.hpp"
#include "src/core/threads.hpp"

namespace peristat {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Calls visit(law) if the bonds can be damaged; law.of_bond(bond) is that of one of them.
template <class Visit>
void with_law(const Model& model, const Visit& visit) {
  if (const BondFailure* const bonds = model.failing_bonds()) bonds->with_damage_law(visit);
}

/// Stretch that a law bears after a strength is exceeded.
template <class Law>
double borne_after(const Law& law, double strength) {
  if constexpr (StepwiseLaw<Law>) {
    return law.borne_after(strength);
  } else {
    throw std::logic_error("a law whose force falls smoothly has no drops");
  }
}

template <class Law>
bool falls_by_steps(const Law& law) {
  if constexpr (requires { law.falls_by_steps(); }) {
    return law.falls_by_steps();
  } else {
    return StepwiseLaw<Law>;
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

/// Calls visit(thread, point, bond, look) for every bond with a finite borne stretch, on several
/// threads; each thread visits consecutive bonds.
template <class Visit>
void for_each_bearing(const Points& points, const Model& model, const StateView& at,
                      std::span<const double> borne, int threads, const Visit& visit) {
  const Bonds& bonds = model.bonds();
  const auto in_dimension = [&](const auto& look) {
    run_on_threads(threads, [&](int thread) {
      const std::ptrdiff_t count = bonds.points();
      const Index first = Index(count * thread / threads);
      const Index last = Index(count * (thread + 1) / threads);
      for (Index i = first; i < last; ++i) {
        for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
          if (borne[std::size_t(bond)] < infinite) visit(thread, i, bond, look);
        }
      }
    });
  };
  switch (points.dimension) {
    case 1:
      return in_dimension(BondLook<1>(points, bonds, at));
    case 2:
      return in_dimension(BondLook<2>(points, bonds, at));
    default:
      return in_dimension(BondLook<3>(points, bonds, at));
  }
}

}  // namespace

std::vector<double> borne_stretches(const Model& model, const History& history) {
  const std::span<const double> largest = bond_stretches(model, history);
  std::vector<double> borne(largest.size());
  with_law(model, [&](const auto& laws) {
    for (std::size_t bond = 0; bond < borne.size(); ++bond) {
      borne[bond] = model.bonds().weight(Offset(bond)) == 0.0
                        ? infinite
                        : laws.of_bond(Offset(bond)).borne(largest[bond]);
    }
  });
  return borne;
}

bool fails_by_steps(const Model& model) {
  bool all = model.failing_bonds() != nullptr;
  with_law(model, [&](const auto& laws) {
    for (Offset bond = 0; all && bond < model.bonds().count(); ++bond) {
      all = falls_by_steps(laws.of_bond(bond).law);
    }
  });
  return all;
}

BondDrops drop(const Points& points, const Model& model, const StateView& at,
               std::span<const double> borne, std::span<const UtilisedBond> bonds) {
  const std::span<const double> before = bond_stretches(model, at.history);
  BondDrops result{{before.begin(), before.end()}, {borne.begin(), borne.end()}};
  const Bonds& network = model.bonds();
  with_law(model, [&](const auto& laws) {
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
      result.energy_lost += volume * (stored.value - left.value);
      result.dissipated += volume * (law.dissipated(after) - law.dissipated(largest));
      result.stiffness.push_back(
          {bond, one.first_point, network.partner[bond],
           direction(points, at, one.first_point, network.partner[bond]),
           (stored.second - left.second) * network.weight(bond) * network.inverse_length(bond)});
      largest = after;
      result.borne[std::size_t(bond)] = law.borne(after);
      result.breaking += law.is_broken(after);
    }
  });
  return result;
}

std::vector<UtilisedBond> utilised_bonds(const Points& points, const Model& model,
                                         const StateView& at, std::span<const double> borne,
                                         double least, int threads) {
  std::vector<std::vector<UtilisedBond>> parts(static_cast<std::size_t>(threads));
  for_each_bearing(points, model, at, borne, threads,
                   [&](int thread, Index i, Offset bond, const auto& look) {
                     const double stretch = look.stretch(i, bond);
                     const double utilisation = stretch / borne[std::size_t(bond)];
                     if (utilisation >= least) {
                       parts[std::size_t(thread)].push_back({bond, i, utilisation, stretch});
                     }
                   });
  std::vector<UtilisedBond> found;
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::ranges::sort(found, [](const UtilisedBond& a, const UtilisedBond& b) {
    return std::tuple(-a.utilisation, a.bond) < std::tuple(-b.utilisation, b.bond);
  });
  return found;
}

AdmissibleRange admissible_range(const Points& points, const Model& model, const StateView& at,
                                 std::span<const double> borne, std::span<const double> rate,
                                 std::span<const double> eigenstretch_rate, double share,
                                 int threads) {
  std::vector<AdmissibleRange> parts(static_cast<std::size_t>(threads));
  for_each_bearing(points, model, at, borne, threads,
                   [&](int thread, Index i, Offset bond, const auto& look) {
                     AdmissibleRange& part = parts[std::size_t(thread)];
                     const auto [stretch, speed] = look.along(i, bond, rate, eigenstretch_rate);
                     const double strength = borne[std::size_t(bond)];
                     const double way = (share * strength - stretch) / speed;
                     if (speed > 0.0) part.high = std::min(part.high, way);
                     if (speed < 0.0) part.low = std::max(part.low, way);
                     part.utilisation = std::max(part.utilisation, stretch / strength);
                   });
  AdmissibleRange range;
  for (const AdmissibleRange& part : parts) {
    range.low = std::max(range.low, part.low);
    range.high = std::min(range.high, part.high);
    range.utilisation = std::max(range.utilisation, part.utilisation);
  }
  return range;
}

double largest_utilisation(const Points& points, const Model& model, const StateView& at,
                           std::span<const double> borne, int threads) {
  std::vector<double> parts(static_cast<std::size_t>(threads), 0.0);
  for_each_bearing(points, model, at, borne, threads,
                   [&](int thread, Index i, Offset bond, const auto& look) {
                     double& part = parts[std::size_t(thread)];
                     part = std::max(part, look.stretch(i, bond) / borne[std::size_t(bond)]);
                   });
  return *std::ranges::max_element(parts);
}

}  // namespace peristat
