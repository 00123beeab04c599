#include "solvers/observe/point_fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>

#include "assembly/terms/damage.hpp"
#include "solvers/observe/observation.hpp"
#include "solvers/observe/stress_fields.hpp"
#include "solvers/study/motion.hpp"
#include "src/geometry/point_sizes.hpp"

namespace peristat {
namespace {

std::string pair_of_axes(int row, int column) { return {"xyz"[row], "xyz"[column]}; }

/// The first values of an array per degree of freedom: those of the recorded points.
std::vector<double> recorded(const Observation& in, std::span<const double> values) {
  const auto dofs = std::size_t(in.points().count()) * std::size_t(in.points().dimension());
  if (values.size() < dofs) throw std::logic_error("observation: force or velocity is missing");
  return {values.begin(), values.begin() + std::ptrdiff_t(dofs)};
}

std::vector<double> force(Observation& in) {
  std::vector<double> force = recorded(in, in.extras().force);
  in.extras().force = std::vector<double>();
  return force;
}

/// Forces of the state less those without contacts.
std::vector<double> contact_force(Observation& in) {
  const auto dofs = std::size_t(in.body().conditions->constraints().dofs());
  std::vector<double> with(dofs, 0.0), without(dofs, 0.0);
  if (in.assembler().has_contacts()) {
    StateView view = in.at();
    static_cast<void>(in.assembler().gradient(view, with));
    view.has_contacts = false;
    static_cast<void>(in.assembler().gradient(view, without));
  }
  for (std::size_t k = 0; k < dofs; ++k) with[k] = without[k] - with[k];
  in.body().conditions->constraints().fold_images(with);
  return recorded(in, with);
}

/// |f| / A, with A = h^(d-1) of the size h of a point, times the thickness in 2D; the
/// cross-section in 1D.
std::vector<double> contact_pressure(Observation& in) {
  const int d = in.points().dimension();
  const double section = in.body().setting.cross_section;
  const std::vector<double>& force = in.values("contact_force");
  std::vector<double> pressure(std::size_t(in.points().count()));
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    double squares = 0.0;
    for (int c = 0; c < d; ++c) squares += std::pow(force[i * std::size_t(d) + std::size_t(c)], 2);
    const double size = size_of_point(in.body().points, Index(i), section);
    pressure[i] = std::sqrt(squares) / (section * std::pow(size, d - 1));
  }
  return pressure;
}

std::vector<double> damage(Observation& in) {
  const Body& body = in.body();
  std::vector<double> damage(body.points.volume.size());
  const auto cut_weight =
      in.extras().count_cracks ? std::span(body.cut_weight) : std::span<const double>();
  static_cast<void>(assess_damage(body.model, in.at().history, cut_weight, damage, &body.points));
  damage.resize(std::size_t(in.points().count()));
  return damage;
}

std::vector<double> energy_density(Observation& in) {
  const Points& points = in.body().points;
  std::vector<double> energy(points.volume.size());
  in.assembler().point_energies(in.at(), energy);
  for (auto i = std::size_t(points.own()); i < energy.size(); ++i) {
    energy[std::size_t(points.source(Index(i)))] += energy[i];
  }
  energy.resize(std::size_t(in.points().count()));
  for (std::size_t i = 0; i < energy.size(); ++i) energy[i] /= points.volume[i];
  return energy;
}

/// Least of the unbroken bonds; 0 where all have broken, 1 where there are none.
std::vector<double> life(Observation& in) {
  const Bonds& bonds = in.body().model.bonds();
  const std::vector<char> broken = broken_bonds(in.body().model, in.at().history);
  std::vector<double> least(in.body().points.volume.size(), 1.0);
  std::vector<char> is_whole(least.size(), 0), is_broken(least.size(), 0);
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto b = std::size_t(bond);
      const bool breaks = !broken.empty() && broken[b];
      const double left = in.extras().life.empty() ? 1.0 : in.extras().life[b];
      for (const Index point : {i, bonds.partner(i, bond)}) {
        (breaks ? is_broken : is_whole)[std::size_t(point)] = 1;
        if (!breaks) least[std::size_t(point)] = std::min(least[std::size_t(point)], left);
      }
    }
  }
  least.resize(std::size_t(in.points().count()));
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (is_broken[i] && !is_whole[i]) least[i] = 0.0;
  }
  return least;
}

std::vector<double> stretch(Observation& in) { return std::move(in.stretches().of_points); }

std::vector<double> fragment(Observation& in) {
  const std::span<const std::int32_t> piece = in.extras().piece;
  std::vector<double> numbers(std::size_t(in.points().count()));
  std::copy_n(piece.begin(), std::min(piece.size(), numbers.size()), numbers.begin());
  return numbers;
}

/// Takes a part of the stress that no other field takes.
template <std::vector<double> Stress::*part>
std::vector<double> part_of_stress(Observation& in) {
  return std::move(in.stress().*part);
}

/// tr F - d.
std::vector<double> divergence(Observation& in) {
  const auto d = std::size_t(in.points().dimension());
  const std::vector<double>& gradients = in.values("deformation_gradient");
  std::vector<double> traces(std::size_t(in.points().count()));
  for (std::size_t i = 0; i < traces.size(); ++i) {
    for (std::size_t c = 0; c < d; ++c) traces[i] += gradients[i * d * d + c * (d + 1)] - 1.0;
  }
  return traces;
}

std::vector<double> strain(Observation& in) {
  return symmetric_parts(in.values("green_lagrange_strain"), std::size_t(in.points().dimension()));
}

std::vector<double> stress_halves(Observation& in) {
  return symmetric_parts(in.values("cauchy_stress"), std::size_t(in.points().dimension()));
}

std::vector<double> lacking(Observation& in) {
  return missing_neighbourhood(in.body(), in.at(), in.stress().is_determined);
}

std::vector<double> kinetic_energy_density(Observation& in) {
  const auto d = std::size_t(in.points().dimension());
  const std::vector<double>& velocity = in.values("velocity");
  const std::vector<double> density = densities_of(in.body());
  std::vector<double> energy(std::size_t(in.points().count()));
  for (std::size_t k = 0; k < velocity.size(); ++k) {
    energy[k / d] += 0.5 * density[k / d] * velocity[k] * velocity[k];
  }
  return energy;
}

}  // namespace

const std::vector<PointField>& point_fields() {
  using enum FieldRank;
  using enum FieldNeeds;
  using S = Stress;
  constexpr ShownBy steps = ShownBy::steps, both = ShownBy::both;
  static const std::vector<PointField> fields{
      {"displacement", "m", "displacement of each point", vector,
       [](Observation& in) { return recorded(in, in.at().displacement); }},
      {"force", "N", "internal force on each point: minus the derivative of the stored energy",
       vector, force},
      {"damage", "1", "damage of each point, 0 intact to 1", scalar, damage},
      {"energy_density", "J/m3", "stored energy per volume of each point", scalar, energy_density},
      {"stretch", "1",
       "largest stretch of the unbroken bonds of each point: current / reference length - 1",
       scalar, stretch},
      {"contact_force", "N", "force of contacts with points and obstacles on each point", vector,
       contact_force, nothing, ShownBy::probes},
      {"contact_pressure", "Pa",
       "magnitude of the force of contacts on each point, over the area of a face of its cell",
       scalar, contact_pressure, contacts, both},
      {"fragment", "1",
       "number of the floating piece that the point belongs to; 0: held by the supports", scalar,
       fragment, nothing, steps},
      {"deformation_gradient", "1",
       "deformation gradient F from the unbroken bonds of each point, least squares; identity "
       "where they give none",
       tensor, part_of_stress<&S::deformation_gradient>, stress, both},
      {"divergence", "1", "trace of F - I", scalar, divergence, stress, ShownBy::probes},
      {"green_lagrange_strain", "1", "strain E = (F^T F - I) / 2", tensor,
       part_of_stress<&S::strain>, stress, steps},
      {"first_piola_stress", "Pa",
       "first Piola-Kirchhoff stress P, the virial of each point over its volume", tensor,
       part_of_stress<&S::first_piola>, stress, both},
      {"cauchy_stress", "Pa", "Cauchy stress P F^T / det F; 0 where the unbroken bonds give no F",
       tensor, part_of_stress<&S::cauchy>, stress, steps},
      {"strain", "1", "green_lagrange_strain: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz",
       symmetric, strain, stress, both},
      {"stress", "Pa",
       "symmetric part of cauchy_stress: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz", symmetric,
       stress_halves, stress, both},
      {"von_mises", "Pa", "von Mises stress", scalar, part_of_stress<&S::von_mises>, stress, both},
      {"principal_stress", "Pa", "principal values of the Cauchy stress, the largest first",
       principal, part_of_stress<&S::principal>, stress, both},
      {"principal_direction", "1", "unit vectors of the principal stresses, one per row", tensor,
       part_of_stress<&S::principal_direction>, stress, steps},
      {"missing_neighbourhood", "1",
       "share of a complete neighbourhood that each point lacks because of surfaces, cracks and "
       "broken bonds; 1 where the unbroken bonds give no F",
       scalar, lacking, stress, both},
      {"velocity", "m/s", "velocity of each point", vector,
       [](Observation& in) { return recorded(in, in.extras().velocity); }, motion, both},
      {"kinetic_energy_density", "J/m3", "kinetic energy per volume of each point", scalar,
       kinetic_energy_density, motion, both},
      {"life", "1",
       "smallest remaining life of the unbroken bonds of each point, 1 at first; 0 where all have "
       "broken",
       scalar, life, fatigue, both}};
  return fields;
}

const PointField* point_field(const std::string& name) {
  const auto found = std::ranges::find(point_fields(), name, &PointField::name);
  return found == point_fields().end() ? nullptr : &*found;
}

std::vector<std::string> PointField::components(int dimension) const {
  if (rank == FieldRank::symmetric) {
    if (dimension == 1) return {"xx"};
    if (dimension == 2) return {"xx", "yy", "xy"};
    return {"xx", "yy", "zz", "xy", "yz", "xz"};
  }
  std::vector<std::string> names;
  for (int r = 0; r < dimension && rank != FieldRank::scalar; ++r) {
    if (rank == FieldRank::vector) names.emplace_back(1, "xyz"[r]);
    if (rank == FieldRank::principal) names.emplace_back(1, "123"[r]);
    for (int c = 0; c < dimension && rank == FieldRank::tensor; ++c) {
      names.push_back(pair_of_axes(r, c));
    }
  }
  return names;
}

std::vector<std::uint64_t> PointField::extents(int dimension) const {
  const auto d = static_cast<std::uint64_t>(dimension);
  if (rank == FieldRank::scalar) return {};
  if (rank == FieldRank::tensor) return {d, d};
  if (rank == FieldRank::symmetric) return {d * (d + 1) / 2};
  return {d};
}

std::vector<double> PointField::at(const std::vector<double>& values, int dimension,
                                   Index point) const {
  std::size_t width = 1;
  for (const std::uint64_t extent : extents(dimension)) width *= extent;
  const auto first = values.begin() + std::ptrdiff_t(std::size_t(point) * width);
  return {first, first + std::ptrdiff_t(width)};
}

std::vector<std::string> component_names() {
  std::vector<std::string> names{"x", "y", "z", "1", "2", "3"};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) names.push_back(pair_of_axes(r, c));
  }
  return names;
}

}  // namespace peristat
