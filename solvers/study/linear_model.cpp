#include "solvers/study/linear_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "assembly/convolutions/lattice_springs.hpp"
#include "assembly/terms/linear/linear_term.hpp"
#include "assembly/terms/points/convolved_term.hpp"
#include "solvers/study/fracture_data.hpp"
#include "solvers/study/state_model.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/lattice_box.hpp"
#include "src/geometry/lattice_frame.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Tolerance of a point's distance from its lattice site, in spacings, and relative one of a
/// volume.
constexpr double lattice_tolerance = 1e-9;

/// Horizon over spacing from which convolutions are faster than sums over bonds: measured in 2D and
/// 3D, where the two break even at 2.
constexpr double least_ratio_of_convolutions = 2.5;

[[noreturn]] void refuse_convolution(const BodySpecification& from, const std::string& why) {
  throw InputError("force_operator", "fft",
                   from.needs_convolutions() ? why + "; this model has no other operator"
                                             : why + "; take \"bonds\"");
}

bool stand_in_place(const Points& points) {
  const LatticeFrame frame(points.dimension, {}, 0.0, points.spacing, points.angle);
  for (Index i = 0; i < points.count(); ++i) {
    Coordinates from_origin = points.position(i);
    for (int c = 0; c < points.dimension; ++c) from_origin[c] -= points.lattice->origin[c];
    for (const double steps : frame.spacings_to(from_origin)) {
      if (std::abs(steps - std::round(steps)) > lattice_tolerance) return false;
    }
  }
  return true;
}

/// Returns the lattice box of a body; refuses forces that are no convolution over a lattice.
LatticeBox box_of(const BodySpecification& from, const Points& points) {
  if (!from.is_uniform()) {
    refuse_convolution(from,
                       "is for bodies of one material: with regions, fibres or random fields the "
                       "stiffness of a bond does not depend on its lattice vector alone");
  }
  if (from.surface_correction != SurfaceCorrection::none) {
    refuse_convolution(from,
                       "does not go with a surface_correction, which has a factor for each bond");
  }
  if (points.own() < points.count()) {
    if (!from.cracks.empty()) {
      refuse_convolution(from, "does not go with pre-cracks beside planes of symmetry or periods");
    }
    if (from.form == SolidForm::printed) {
      refuse_convolution(from,
                         "with the form printed does not go with planes of symmetry and periods, "
                         "across which forces without a potential have no image");
    }
  }
  if (!points.neighbours.empty()) refuse_convolution(from, "finds its neighbours by itself");
  std::string why_not;
  std::optional<LatticeBox> box = lattice_box(points, why_not);
  if (!box) refuse_convolution(from, "needs points on a lattice: " + why_not);
  if (!stand_in_place(points)) {
    refuse_convolution(from, "needs points at the sites of the lattice");
  }
  const auto [least, most] = std::minmax_element(points.volume.begin(), points.volume.end());
  if (*most - *least > lattice_tolerance * *most) {
    refuse_convolution(from, "needs points of equal volume, that of a cell");
  }
  return std::move(*box);
}

void add_vertices(const Crack& crack, std::vector<Coordinates>& vertices) {
  std::visit(
      [&]<class C>(const C& of) {
        if constexpr (std::is_same_v<C, CrackSegment>) {
          vertices.insert(vertices.end(), {of.from, of.to});
        } else if constexpr (std::is_same_v<C, CrackShape>) {
          const Box box = bounds(of.shape);
          vertices.insert(vertices.end(), {of.image.place(box.min), of.image.place(box.max)});
        } else {
          for (const auto& vertex : of.vertices) {
            Coordinates at{};
            std::copy(vertex.begin(), vertex.end(), at.begin());
            vertices.push_back(at);
          }
        }
      },
      crack);
}

/// Points whose bonds of that reach may meet a crack, ascending.
std::vector<Index> points_near(const Points& points, const std::vector<Crack>& cracks,
                               double reach) {
  std::vector<bool> is_near(std::size_t(points.count()), false);
  for (const Crack& crack : cracks) {
    std::vector<Coordinates> vertices;
    add_vertices(crack, vertices);
    Coordinates low = vertices.front(), high = low;
    for (const Coordinates& at : vertices) {
      for (std::size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], at[c]);
        high[c] = std::max(high[c], at[c]);
      }
    }
    for (Index i = 0; i < points.count(); ++i) {
      const Coordinates at = points.position(i);
      bool is_inside = true;
      for (std::size_t c = 0; c < std::size_t(points.dimension); ++c) {
        is_inside = is_inside && at[c] >= low[c] - reach && at[c] <= high[c] + reach;
      }
      if (is_inside) is_near[std::size_t(i)] = true;
    }
  }
  std::vector<Index> near;
  for (Index i = 0; i < points.count(); ++i) {
    if (is_near[std::size_t(i)]) near.push_back(i);
  }
  return near;
}

/// The bonds that cracks cut, with their weights, found among the points near the cracks.
Bonds cut_of_lattice(const Points& points, const BondSetting& setting,
                     const std::vector<Crack>& cracks, int threads) {
  const std::vector<Index> near =
      points_near(points, cracks, setting.reach() + points.spacing.largest());
  Points part;
  part.dimension = points.dimension;
  part.spacing = points.spacing;
  part.angle = points.angle;
  part.cell_volume = points.cell_volume;
  part.lattice = points.lattice;
  for (const Index i : near) {
    for (int c = 0; c < points.dimension; ++c) {
      part.reference.push_back(
          points.reference[std::size_t(i) * std::size_t(points.dimension) + std::size_t(c)]);
    }
    part.volume.push_back(points.volume[std::size_t(i)]);
  }
  Bonds bonds = make_bonds(part, SurfaceCorrection::none, setting, threads);
  bonds.remove_if([&](Index i, Offset bond) {
    const Coordinates a = part.position(i), b = part.position(bonds.partner[bond]);
    return std::ranges::none_of(cracks, [&](const Crack& crack) { return cuts(crack, a, b); });
  });
  Bonds result;
  result.offset.assign(std::size_t(points.count()) + 1, 0);
  for (std::size_t k = 0; k < near.size(); ++k) {
    result.offset[std::size_t(near[k]) + 1] = bonds.offset[k + 1] - bonds.offset[k];
  }
  for (std::size_t i = 0; i + 1 < result.offset.size(); ++i) {
    result.offset[i + 1] += result.offset[i];
  }
  for (const Index partner : bonds.partner) result.partner.push_back(near[std::size_t(partner)]);
  result.kind = std::move(bonds.kind);
  return result;
}

CutBonds told(const Bonds& bonds) {
  CutBonds cut{std::vector<double>(std::size_t(bonds.points()), 0.0), {}};
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner[bond];
      cut.weight[std::size_t(i)] += bonds.weight(bond);
      cut.weight[std::size_t(j)] += bonds.weight(bond);
      cut.ends.push_back({i, j});
    }
  }
  return cut;
}

/// Energy that each point bears: W_c of its material, times its volume.
BearableEnergies bearable_energies(const PointMaterials& materials, const Points& points,
                                   double horizon) {
  const auto& all = materials.all();
  if (std::ranges::none_of(all, [](const auto& material) {
        return material.of->damage.law == DamageLaw::energy_density;
      })) {
    return {};
  }
  std::vector<double> bearable(std::size_t(points.count()),
                               std::numeric_limits<double>::infinity());
  for (Index i = 0; i < points.count(); ++i) {
    const DamageSpecification& damage = all[materials.of(i)].of->damage;
    if (damage.law != DamageLaw::energy_density) continue;
    bearable[std::size_t(i)] =
        bearable_energy_density(damage, horizon) * points.volume[std::size_t(i)];
  }
  for (const auto& material : all) {
    for (const std::string& set : material.of->damage.no_fail) {
      const auto found = points.sets.find(set);
      if (found == points.sets.end()) {
        throw InputError(material.key + ".damage.no_fail", '"' + set + '"', "no set of this name");
      }
      for (const Index i : found->second) {
        bearable[std::size_t(i)] = std::numeric_limits<double>::infinity();
      }
    }
  }
  return bearable;
}

}  // namespace

ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                              bool is_explicit) {
  if (from.needs_convolutions()) return ForceOperator::fft;
  // With images convolutions take twice as long.
  const bool has_images = !from.constraints.symmetries.empty() || !from.constraints.periods.empty();
  const bool may_be = (from.is_linear() || from.has_states()) && !has_images;
  const double ratio = from.horizon / points.spacing;
  if (!may_be || !is_explicit || ratio < least_ratio_of_convolutions) return ForceOperator::bonds;
  BodySpecification convolved = from;
  convolved.force_operator = ForceOperator::fft;
  try {
    check_specification(convolved, points);
    static_cast<void>(box_of(convolved, points));
  } catch (const InputError&) {  // no convolution; other errors are reported for bonds, too
    return ForceOperator::bonds;
  }
  return ForceOperator::fft;
}

BondSetting network_setting(const BodySpecification& from, const Points& points,
                            BondSetting setting) {
  if (from.force_operator != ForceOperator::fft) return setting;
  std::array<double, 3> edge{};
  for (int c = 0; c < points.dimension; ++c) edge[std::size_t(c)] = points.spacing.along(c);
  std::ranges::sort(edge, std::greater<>());
  constexpr double beyond = 1.01;  // includes the diagonal itself
  setting.horizon = std::min(setting.horizon, beyond * std::hypot(edge[0], edge[1]));
  setting.shape = HorizonShape::ball;
  setting.volume_correction = VolumeCorrection::none;
  return setting;
}

namespace {

/// Data that all models by convolutions have.
/// @param cut receives the bonds that pre-cracks have cut
ConvolvedLattice lattice_of(const BodySpecification& from, const Points& points,
                            const BondSetting& of_springs, double modulus, CutBonds& cut,
                            int threads) {
  ConvolvedLattice lattice;
  lattice.box = box_of(from, points);
  lattice.own = std::size_t(points.own());
  lattice.springs =
      lattice_springs(of_springs, points.spacing, points.angle, modulus, points.volume.front());
  if (!from.cracks.empty()) {
    cut = told(cut_of_lattice(points, of_springs, from.cracks, threads));
    lattice.box.cut = cut.ends;
  }
  lattice.all_bonds = [&points, of_springs, cracks = from.cracks, threads] {
    Bonds all = make_bonds(points, SurfaceCorrection::none, of_springs, threads);
    if (points.own() < points.count()) drop_weightless(all);
    static_cast<void>(cut_bonds(all, points, cracks));
    return all;
  };
  return lattice;
}

LamePair constants_of(const MaterialSpecification& material, int dimension) {
  return lame_constants(*material.youngs_modulus, *material.poisson_ratio, dimension,
                        material.plane);
}

/// Makes a solid by convolutions. Its springs have the solid's Young's modulus and influence.
Model make_convolved_solid(const BodySpecification& from, const PointMaterials& materials,
                           const Points& points, const BondSetting& setting, Bonds bonds,
                           CutBonds& cut, int threads) {
  const MaterialSpecification& material = *materials.all().front().of;
  const BondSetting of_springs = state_setting(setting);
  const double modulus = micromodulus(*material.youngs_modulus, of_springs);
  const double volume = points.volume.front();
  const SolidForces form =
      from.form == SolidForm::printed ? SolidForces::printed : SolidForces::energy;
  return Model(std::make_shared<LinearTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), modulus,
      bearable_energies(materials, points, setting.horizon),
      lattice_of(from, points, of_springs, modulus, cut, threads), threads,
      ConvolvedSolid{
          lattice_arms(setting, points.spacing, points.angle, volume),
          {constants_of(material, points.dimension), volume, form, std::size_t(points.own())}}));
}

Model make_green_bonds(const BodySpecification& from, const PointMaterials& materials,
                       const Points& points, const BondSetting& setting, Bonds bonds, CutBonds& cut,
                       int threads) {
  const PointMaterials::Material& material = materials.all().front();
  const double modulus = micromodulus_of(*material.of, material.key, setting).at(1.0);
  return Model(std::make_shared<ConvolvedTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), modulus,
      bearable_energies(materials, points, setting.horizon),
      lattice_of(from, points, setting, modulus, cut, threads), ConvolvedGreenBonds{}, threads));
}

/// Micromodulus of bonds that have the same bulk modulus.
double modulus_of_bulk(const LamePair& constants, const BondSetting& setting) {
  const int d = setting.dimension;
  const LamePair of_bonds = lame_constants(1.0, poisson_ratio(setting), d, setting.plane);
  const auto bulk = [d](const LamePair& of) { return of.lambda + 2.0 * of.mu / d; };
  return micromodulus(bulk(constants) / bulk(of_bonds), setting);
}

/// Refuses points without a deformation gradient, whose neighbours all lie along a line or in a
/// plane.
void require_gradients(const Correspondence& material) {
  const std::size_t without = material.points_without_gradient();
  if (without == 0) return;
  throw InputError(
      "points", std::to_string(without),
      "of them have neighbours only along a line or in a plane, which determine no deformation "
      "gradient; resolve thin parts with more points, or take another model");
}

/// Makes a correspondence material. Its springs have the material's Young's modulus; beta is
/// stabilisation times the micromodulus of bonds of its bulk modulus, over the horizon ([FCBM]
/// A-12, as a material of its own unit).
Model make_correspondence(const BodySpecification& from, const PointMaterials& materials,
                          const Points& points, const BondSetting& setting, Bonds bonds,
                          CutBonds& cut, int threads) {
  const MaterialSpecification& material = *materials.all().front().of;
  const double modulus = micromodulus(*material.youngs_modulus, setting);
  const double volume = points.volume.front();
  ConvolvedCorrespondence law;
  law.arms = lattice_arms(setting, points.spacing, points.angle, volume);
  law.setting.constants = constants_of(material, points.dimension);
  law.setting.volume = volume;
  law.setting.own = std::size_t(points.own());
  law.setting.stabilisation =
      material.stabilisation * modulus_of_bulk(law.setting.constants, setting) / setting.horizon;
  ConvolvedLattice lattice = lattice_of(from, points, setting, modulus, cut, threads);
  require_gradients(Correspondence(lattice.box, {}, law.arms, law.setting, threads));
  return Model(
      std::make_shared<ConvolvedTerm>(std::make_shared<const Bonds>(std::move(bonds)), modulus,
                                      bearable_energies(materials, points, setting.horizon),
                                      std::move(lattice), std::move(law), threads));
}

}  // namespace

Model make_linear_model(const BodySpecification& from, const PointMaterials& materials,
                        const PointFactors& factors, const Points& points,
                        const BondSetting& setting, Bonds bonds, CutBonds& cut,
                        const IndexMap& index_map, int threads) {
  if (points.own() < points.count()) drop_weightless(bonds);
  if (from.force_operator == ForceOperator::fft) {
    static_cast<void>(cut_bonds(bonds, points, from.cracks));
  }
  if (from.has_states()) {
    return make_convolved_solid(from, materials, points, setting, std::move(bonds), cut, threads);
  }
  if (from.material.model == MaterialModel::green_bond) {
    return make_green_bonds(from, materials, points, setting, std::move(bonds), cut, threads);
  }
  if (from.material.model == MaterialModel::correspondence) {
    return make_correspondence(from, materials, points, setting, std::move(bonds), cut, threads);
  }
  std::vector<DirectedConstant> moduli;
  for (const auto& material : all_materials(from, materials)) {
    moduli.push_back(micromodulus_of(*material.of, material.key, setting));
  }
  const BondMaterials mixed(from, materials, factors, points, std::move(moduli));
  std::optional<ConvolvedLattice> lattice;
  if (from.force_operator == ForceOperator::fft) {
    lattice = lattice_of(from, points, setting, mixed.modulus(), cut, threads);
  } else {
    if (!from.is_uniform()) {
      refuse_idle_interfaces(from, materials, bonds, index_map.ranks());
      mixed.weigh(bonds);
    }
    cut = cut_bonds(bonds, points, from.cracks);
  }
  return Model(std::make_shared<LinearTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), mixed.modulus(),
      bearable_energies(materials, points, setting.horizon), std::move(lattice), threads));
}

}  // namespace peristat
