#include "solvers/formulations/lps_collocation/collocation_model.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "assembly/terms/collocation/collocation_term.hpp"
#include "assembly/terms/collocation/make_collocation_network.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Number of bonds within which each point finds a whole ball: a square corner needs two, an angle
/// of 30 degrees four.
constexpr int farthest_whole_ball = 4;

/// Position of the first point of the whole body whose entry is 0; nothing if there is none.
std::optional<Coordinates> first_without(const std::vector<double>& has, const Points& points,
                                         const IndexMap& index_map) {
  constexpr double nowhere = 1e300;
  const Index own = points.owned.value_or(points.count());
  const Index here = Index(std::find(has.begin(), has.begin() + own, 0.0) - has.begin());
  const double number = here < own ? double(index_map.number_of(here)) : nowhere;
  const double first = index_map.ranks().min(number);
  if (first == nowhere) return std::nullopt;
  Coordinates place{};
  if (number == first) place = points.position(here);
  add_up(index_map.ranks(), place);
  return place;
}

/// Refuses bodies thinner than two horizons. Between such faces no ball is whole, and deficits of
/// surfaces are made up from points with the same deficit: the operator has eigenvalues of the
/// other sign, so that a strip bends against its load.
void refuse_thin_bodies(const Points& points, const CollocationNetwork& network,
                        const IndexMap& index_map) {
  const Index own = points.owned.value_or(points.count());
  std::vector<double> near(network.is_whole.begin(), network.is_whole.end());
  index_map.update_ghost_values(near);
  for (int bonds = 0; bonds < farthest_whole_ball; ++bonds) {
    const std::vector<double> before = near;
    for (Index i = 0; i < own; ++i) {
      for (Offset e = network.offset[i]; e < network.offset[i + 1] && near[i] == 0.0; ++e) {
        near[i] = before[std::size_t(network.neighbour[std::size_t(e)])];
      }
    }
    index_map.update_ghost_values(near);
  }
  const std::optional<Coordinates> at = first_without(near, points, index_map);
  if (!at) return;
  throw InputError("material.model", "lps",
                   "needs bodies thicker than two horizons: no point within four bonds of the one "
                   "at " +
                       place_text(*at, points.dimension) +
                       " m has a complete neighbourhood; take a smaller spacing or horizon_ratio, "
                       "or quadrature.form = \"energy\"");
}

/// Normals of the face above a point that has a single face and no cut bonds; zero elsewhere.
std::vector<double> normals_of_faces(const BodySpecification& from, const Points& points,
                                     double horizon, const CollocationNetwork& network,
                                     const CutBonds& cut) {
  if (!from.boundary) {
    throw InputError("quadrature.normals", "exact",
                     "needs a lattice in shapes, whose faces give the normals");
  }
  const auto d = std::size_t(points.dimension);
  std::vector<double> normals(points.reference.size(), 0.0);
  for (Index i = 0; i < points.owned.value_or(points.count()); ++i) {
    const auto at = std::size_t(i);
    if (network.is_whole[at] != 0 || (!cut.weight.empty() && cut.weight[at] != 0.0)) continue;
    const std::vector<Foot> feet = from.boundary->above(points.position(i), horizon);
    if (feet.size() != 1) continue;
    for (std::size_t c = 0; c < d; ++c) normals[at * d + c] = feet.front().normal[c];
  }
  return normals;
}

/// Describes the weights of the quadrature.
std::string description(const MadeCollocationNetwork& of, int degree, Index points) {
  std::string text = fmt::format(
      "quadrature  exact to degree {}; weights solved for in {} of {} neighbourhoods, {} weights "
      "below 0, the lowest is {:.4g} of a cell",
      degree, of.solves, points, of.negative, of.lowest);
  if (of.lowered > 0)
    text += fmt::format("; exact only to a lower degree at {} points", of.lowered);
  return text;
}

}  // namespace

MadeModel make_collocation_model(const ModelSetting& setting, Bonds bonds) {
  const BodySpecification& from = setting.of;
  const Points& points = setting.points;
  const double horizon = setting.bonds.horizon;
  BondSetting of_bonds = setting.bonds;
  of_bonds.influence = {};
  std::vector<DirectedConstant> moduli;
  for (const auto& material : all_materials(from, setting.materials)) {
    const double energy = crack_energy_of_dilation(lame_constants(*material.of, points.dimension),
                                                   horizon, points.dimension);
    moduli.push_back({{modulus_of_crack(energy, of_bonds), 0.0, 0.0}, {}});
  }
  auto constants = std::make_shared<LameConstants>();
  for (const auto& [lambda, mu] : constants_of_points(setting)) {
    constants->lambda.push_back(lambda);
    constants->mu.push_back(mu);
  }
  const BondMaterials mixed(from, setting.materials, setting.factors, points, std::move(moduli));
  if (!from.is_uniform()) {
    refuse_idle_interfaces(from, setting.materials, bonds, setting.index_map.ranks());
    mixed.weigh(bonds);
  }
  CutBonds cut = cut_bonds(bonds, points, from.cracks);
  MadeCollocationNetwork made =
      make_collocation_network(points, bonds, horizon, from.collocation.degree, setting.threads);
  const std::string summary = description(made, from.collocation.degree, points.count());
  refuse_thin_bodies(points, made.network, setting.index_map);
  if (from.collocation.normals == NormalSource::exact) {
    made.network.normals = normals_of_faces(from, points, horizon, made.network, cut);
  }
  auto local = std::make_shared<CollocationNetwork>(make_local_network(points, bonds));
  auto whole = std::make_shared<CollocationNetwork>(std::move(made.network));
  auto [potential, never_fails] = mixed.potential(bonds);
  const TractionForm form = from.collocation.traction_form;
  return {Model(std::make_shared<CollocationTerm>(
              std::make_shared<const Bonds>(std::move(bonds)), std::move(potential),
              std::move(never_fails), CollocationSetting{std::move(whole), constants, form},
              CollocationSetting{std::move(local), constants, form})),
          std::move(cut),
          {summary}};
}

}  // namespace peristat
