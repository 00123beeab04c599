#include "solvers/study/body_specification.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

void require(bool holds, const std::string& key, const std::string& value,
             const std::string& allowed) {
  if (!holds) throw InputError(key, value, allowed);
}

void require_positive(const std::optional<double>& value, const std::string& key) {
  if (!value) return;
  require(std::isfinite(*value) && *value > 0.0, key, number_text(*value),
          "must be positive and finite");
}

void require_absent(bool is_given, const std::string& key, const std::string& why) {
  require(!is_given, key, "", why);
}

void require_within(double value, double least, double most, const std::string& key) {
  require(value >= least && value <= most, key, number_text(value),
          "must be from " + number_text(least) + " to " + number_text(most));
}

void check_damage(const DamageSpecification& damage) {
  const std::string table = "material.damage.";
  const bool is_tanh = damage.law == DamageLaw::tanh || damage.law == DamageLaw::tanh_continuous;
  if (damage.law == DamageLaw::none)
    require_absent(damage.critical != 0.0, table + "critical", "needs a law");
  else
    require_within(damage.critical, 1e-9, 1e3, table + "critical");
  if (!is_tanh) {
    require_absent(damage.onset != 0.0, table + "onset", "is for the tanh laws");
    return;
  }
  require_within(damage.onset, 1e-9, 1e3, table + "onset");
  require(damage.onset < damage.critical * (1.0 - 1e-9), table + "onset", number_text(damage.onset),
          "must be smaller than critical");
  require_within(damage.rate, 0.1, 50.0, table + "rate");
}

void check_bond_material(const BodySpecification& of, const Points& points) {
  const MaterialSpecification& material = of.material;
  const std::string for_cpd = "is for the model cpd";
  require(material.youngs_modulus.has_value() != material.micromodulus.has_value(), "material", "",
          "needs a youngs_modulus or a micromodulus, and not both");
  require_absent(material.poisson_ratio.has_value(), "material.poisson_ratio",
                 for_cpd + "; bonds alone have 1/4, in plane stress 1/3");
  require_absent(material.c1.has_value(), "material.c1", for_cpd);
  require_absent(material.c2 != 0.0, "material.c2", for_cpd);
  require_absent(material.c3 != 0.0, "material.c3", for_cpd);
  require_absent(of.weights != InteractionWeights::mean, "weights", for_cpd);
  require(points.spacing.is_square() || of.volume_correction == VolumeCorrection::none,
          "volume_correction", "linear",
          "is for square or cubic cells; spacings that differ need \"none\"");
}

void check_cpd_material(const BodySpecification& of, const Points& points) {
  const int dimension = points.dimension;
  const MaterialSpecification& material = of.material;
  require(dimension > 1, "material.model", "cpd", "needs dimension 2 or 3");
  require_whole_square_cells(points);
  require(material.youngs_modulus.has_value() != material.c1.has_value(), "material", "",
          "needs a youngs_modulus with a poisson_ratio, or c1, and not both");
  require_absent(material.micromodulus.has_value(), "material.micromodulus",
                 "is for the model bond");
  require(material.poisson_ratio.has_value() == material.youngs_modulus.has_value(),
          "material.poisson_ratio", "", "goes with youngs_modulus");
  require(std::isfinite(material.c2), "material.c2", number_text(material.c2), "must be finite");
  require(std::isfinite(material.c3), "material.c3", number_text(material.c3), "must be finite");
  const bool has_moduli = material.youngs_modulus.has_value();
  require_absent(has_moduli && dimension == 2 && material.c2 != 0.0, "material.c2",
                 "follows from youngs_modulus and poisson_ratio in 2D");
  require_absent((has_moduli || dimension == 2) && material.c3 != 0.0, "material.c3",
                 has_moduli ? "follows from youngs_modulus and poisson_ratio" : "must be 0 in 2D");
  const std::string needs_none = "is for the model bond; the effective volumes of cpd need none";
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction", needs_none);
  require_absent(of.surface_correction != SurfaceCorrection::none, "surface_correction",
                 needs_none);
}

void check_horizon(const BodySpecification& of, const Points& points) {
  require_positive(of.horizon, "horizon");
  require(of.horizon >= points.spacing.largest() * (1.0 - horizon_tolerance), "horizon",
          number_text(of.horizon),
          points.spacing.is_square() ? "horizon smaller than the mean spacing of the points, " +
                                           number_text(points.spacing) + " m"
                                     : "the horizon, " + number_text(of.horizon) +
                                           " m, is smaller than the largest spacing, " +
                                           number_text(points.spacing.largest()) + " m");
  require_summable(of.material.model, points.dimension, "horizon", number_text(of.horizon),
                   of.horizon / points.spacing);
}

/// Volumes, spacing and cross-section are not independent of each other.
/// Refuses what would come on top of given shares, or has nothing to do with them.
void check_neighbours(const BodySpecification& of, const Points& points) {
  if (points.neighbours.empty()) return;
  require(of.material.model == MaterialModel::bond, "material.model", "cpd",
          "finds its own neighbours; given ones are for model \"bond\"");
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction",
                 "is for neighbours that are found; given ones have their shares");
  require_absent(
      of.surface_correction == SurfaceCorrection::volume, "surface_correction",
      "\"volume\" is for neighbours that are found: of given ones nobody knows what they "
      "add up to inside a body; give \"energy\" or \"none\"");
}

void check_cross_section(const BodySpecification& of, const Points& points) {
  const double has = points.cross_section();
  const double given = points.dimension == 3 ? 1.0 : of.cross_section;
  if (of.cross_section != 0.0) require_positive(of.cross_section, "cross_section");
  require(points.dimension < 3 || of.cross_section == 0.0 || of.cross_section == 1.0,
          "cross_section", number_text(of.cross_section), "must be 1 in 3D");
  if (given == 0.0) return;
  // The volumes' sum has round-off; a wrong thickness or spacing is off by far more.
  require(std::abs(has / given - 1.0) < 1e-6, "cross_section", number_text(given),
          "does not fit the points, whose mean volume over spacing^" +
              std::to_string(points.dimension) + " is " + number_text(has));
}

void check_shares(const Points& points) {
  const NeighbourShares* before = nullptr;
  for (const NeighbourShares& pair : points.neighbours) {
    const bool ascends =
        before == nullptr || before->i < pair.i || (before->i == pair.i && before->j < pair.j);
    const bool are_points = pair.i >= 0 && pair.i < pair.j && pair.j < points.count();
    const bool are_shares = pair.of_i >= 0.0 && pair.of_j >= 0.0 && pair.of_i + pair.of_j > 0.0 &&
                            std::isfinite(pair.of_i + pair.of_j);
    require(ascends && are_points && are_shares, "points.neighbours", "",
            "must ascend, be of two points each, and have shares of at least 0, not both 0");
    before = &pair;
  }
}

void check_set(const std::string& name, const std::vector<Index>& members, Index points) {
  for (std::size_t k = 0; k < members.size(); ++k) {
    const bool ascends = k == 0 || members[k - 1] < members[k];
    require(ascends && members[k] >= 0 && members[k] < points, "points.sets", '"' + name + '"',
            "has a number that is no point's, or numbers that do not ascend");
  }
}

}  // namespace

void check_points(const Points& points) {
  require(points.dimension >= 1 && points.dimension <= 3, "points.dimension",
          std::to_string(points.dimension), "must be 1, 2 or 3");
  require(points.count() > 0, "points", "", "there are none");
  require(points.reference.size() == points.volume.size() * std::size_t(points.dimension),
          "points.reference", "", "must have dimension entries for every volume");
  require_positive(points.spacing, "points.spacing");
  for (const double at : points.reference)
    require(std::isfinite(at), "points.reference", number_text(at), "must be finite");
  for (const double volume : points.volume) require_positive(volume, "points.volume");
  check_shares(points);
  for (const auto& [name, members] : points.sets) check_set(name, members, points.count());
}

void require_whole_square_cells(const Points& points) {
  require(points.spacing.is_square(), "material.model", "cpd",
          "needs square or cubic cells: its constants and effective volumes are those of a cubic "
          "lattice; give one spacing, or model = \"bond\"");
  const auto is_cut = [&](double volume) {
    return points.cell_volume > 0.0 && std::abs(volume / points.cell_volume - 1.0) > 1e-9;
  };
  require(std::none_of(points.volume.begin(), points.volume.end(), is_cut), "material.model", "cpd",
          "needs whole cells: its effective volumes count neighbours, whatever their volume is; "
          "give volumes = \"cells\", or model = \"bond\"");
}

void check_specification(const BodySpecification& of, const Points& points) {
  const MaterialSpecification& material = of.material;
  check_horizon(of, points);
  check_cross_section(of, points);
  check_neighbours(of, points);
  if (material.model == MaterialModel::bond)
    check_bond_material(of, points);
  else
    check_cpd_material(of, points);
  require_positive(material.youngs_modulus, "material.youngs_modulus");
  require_positive(material.micromodulus, "material.micromodulus");
  require_positive(material.c1, "material.c1");
  require_positive(material.density, "material.density");
  check_damage(material.damage);
  for (std::size_t k = 0; k < of.cracks.size(); ++k)
    check_crack(of.cracks[k], points.dimension, "cracks[" + std::to_string(k) + "]");
}

void require_summable(MaterialModel model, int dimension, const std::string& key,
                      const std::string& value, double ratio) {
  const bool counts_pairs = model == MaterialModel::cpd;
  const double largest = counts_pairs     ? largest_ratio_with_pairs(dimension)
                         : dimension == 3 ? 100.0
                                          : 1000.0;
  if (ratio <= inclusive_radius(largest)) return;
  throw InputError(key, value,
                   "the horizon is " + number_text(ratio) + " spacings; at most " +
                       number_text(largest) + (counts_pairs ? " with model \"cpd\"" : "") + " in " +
                       std::to_string(dimension) + "D");
}

void add_set(Points& points, const SetRule& rule) {
  if (points.sets.contains(rule.name)) {
    throw InputError("name", '"' + rule.name + '"',
                     "there is a set of this name already (sets, layers and the sets of a point "
                     "file share their names)");
  }
  std::vector<Index> members = select(points, rule);
  if (members.empty()) throw InputError("", '"' + rule.name + '"', "the set selects no point");
  points.sets[rule.name] = std::move(members);
}

}  // namespace peristat
