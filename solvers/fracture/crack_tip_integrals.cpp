#include "solvers/fracture/crack_tip_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "assembly/terms/bonds/deformation_gradients.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/geometry/point_sizes.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

Coordinates unit(const Coordinates& vector, const std::string& key) {
  const double length = std::sqrt(dot<3>(vector, vector));
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw InputError(key, "", "must not be zero in every component");
  }
  return scaled<3>(1.0 / length, vector);
}

CrackTipFrame frame_of(const CrackTipSpecification& tip, int dimension, const std::string& key) {
  if (dimension == 1) throw InputError(key, "", "is for dimension 2 and 3");
  CrackTipFrame frame;
  frame.origin = tip.at;
  frame.e1 = unit(tip.direction, key + ".direction");
  frame.e3 = dimension == 2 ? Coordinates{0.0, 0.0, 1.0} : unit(tip.front, key + ".front");
  constexpr double right_angle = 1e-9;
  if (std::abs(dot<3>(frame.e1, frame.e3)) > right_angle) {
    throw InputError(key + ".front", "", "must be at a right angle to direction");
  }
  frame.e2 = cross(frame.e3, frame.e1);
  return frame;
}

/// Falls smoothly from 1 to 0 over [0, 1]; returns the value and its slope.
std::array<double, 2> fall(double t) {
  if (t <= 0.0) return {1.0, 0.0};
  if (t >= 1.0) return {0.0, 0.0};
  return {1.0 - t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t)};
}

constexpr double outer_horizons = 4.0;  // default outer radius of a ring, in horizons

}  // namespace

CrackTipIntegrals::CrackTipIntegrals(const Points& points, const CrackTipSpecification& tip,
                                     const CrackTipSetting& setting, const std::string& key)
    : points_(points), tip_(tip), setting_(setting), frame_(frame_of(tip, points.dimension, key)) {
  constexpr double inner_horizons = 2.0;
  setting_.horizon = horizon_of_ring();
  if (tip_.inner == 0.0) tip_.inner = inner_horizons * setting_.horizon;
  if (tip_.outer == 0.0) tip_.outer = std::max(outer_horizons * setting_.horizon, 2.0 * tip_.inner);
  if (!(tip_.inner >= inner_horizons * setting_.horizon * (1.0 - 1e-9))) {
    throw InputError(key + ".inner", number_text(tip_.inner),
                     "must be at least 2 horizons, " +
                         number_text(inner_horizons * setting_.horizon) +
                         " m: closer to the tip the body is nonlocal");
  }
  if (!(tip_.outer >= tip_.inner + setting_.horizon * (1.0 - 1e-9))) {
    throw InputError(key + ".outer", number_text(tip_.outer),
                     "must be at least a horizon larger than the inner radius, " +
                         number_text(tip_.inner) + " m");
  }
  check_planes(key);
  check_ring(key);
  weigh();
}

std::vector<ImageKind> CrackTipIntegrals::kinds_of_images() const {
  const Images& images = points_.images;
  std::vector<double> is_there(images.kinds.size(), 0.0);
  for (const std::size_t kind : images.kind) is_there[kind] = 1.0;
  is_there = setting_.index_map.ranks().max(is_there);
  std::vector<ImageKind> kinds;
  for (std::size_t kind = 0; kind < is_there.size(); ++kind) {
    if (is_there[kind] > 0.0) kinds.push_back(images.kinds[kind]);
  }
  return kinds;
}

void CrackTipIntegrals::check_planes(const std::string& key) {
  const double reach = tip_.outer + setting_.horizon;
  for (const ImageKind& kind : kinds_of_images()) {
    for (std::size_t axis = 0; axis < std::size_t(points_.dimension); ++axis) {
      if (kind.mirror[axis] > 0.0) continue;
      Coordinates normal{};
      normal[axis] = 1.0;
      const double plane = 0.5 * kind.shift[axis];
      const double distance = std::abs(plane - tip_.at[axis]);
      constexpr double parallel = 1.0 - 1e-9;
      if (std::abs(dot<3>(normal, frame_.e3)) > parallel) {
        is_front_halved_ = true;
      } else if (std::abs(dot<3>(normal, frame_.e2)) > parallel &&
                 distance < 1e-6 * double(points_.spacing)) {
        is_on_plane_ = true;
      } else if (distance < reach) {
        throw InputError(key + ".at", place_text(tip_.at, points_.dimension),
                         "a plane of symmetry passes " + number_text(distance) +
                             " m from it and cuts the ring; the crack must lie in the plane, or "
                             "the distance must be at least the outer radius plus a horizon, " +
                             number_text(reach) + " m");
      }
    }
  }
}

/// Requires that the ring, and half a horizon beyond it, are full of points: within the body's
/// extent, and in all directions but for a slot behind the tip.
void CrackTipIntegrals::check_ring(const std::string& key) const {
  constexpr std::size_t sectors = 16;
  constexpr double full = 0.7, slot = 0.9;  // shares of a sector's volume, of a half turn
  const double outer = tip_.outer + 0.5 * setting_.horizon;
  std::array<double, sectors> volume{};
  std::array<double, 4> extent{};  // ahead, behind, above, below
  double above = 0.0;              // positive if the points that are no images lie above the crack
  for (Index i = 0; i < points_.count(); ++i) {
    if (!points_.owns(i)) continue;
    const Coordinates at = frame_.components(points_.position(i));
    if (!points_.is_image(i)) above += at[1];
    const std::array<double, 4> along{at[0], -at[0], at[1], -at[1]};
    for (std::size_t k = 0; k < extent.size(); ++k) extent[k] = std::max(extent[k], along[k]);
    const double r = std::hypot(at[0], at[1]);
    if (r < tip_.inner || r > outer) continue;
    const double turn = (std::atan2(at[1], at[0]) + std::numbers::pi) / (2.0 * std::numbers::pi);
    const auto sector = std::min(sectors - 1, std::size_t(turn * double(sectors)));
    volume[sector] += points_.volume[points_.source(i)];
  }
  const std::vector<double> volumes = sums().of_all(std::vector(volume.begin(), volume.end()));
  for (double& most : extent) most = sums().largest_of_all(most);
  above = sums().of_all(above);
  const auto refuse = [&](const std::string& where) {
    throw InputError(
        key + ".outer", number_text(tip_.outer),
        "the ring from " + number_text(tip_.inner) + " to " + number_text(tip_.outer) +
            " m meets the body's edge or a hole, or is closer to it than half a horizon, " + where +
            "; take a smaller ring, which a finer spacing allows");
  };
  if (is_on_plane_) extent[above > 0.0 ? 3 : 2] = outer;
  constexpr std::array<const char*, 4> names{"ahead of the tip", "behind the tip",
                                             "above the crack", "below the crack"};
  for (std::size_t k = 0; k < extent.size(); ++k) {
    if (extent[k] + 0.51 * double(points_.spacing) < outer) refuse(names[k]);
  }
  const double ring = std::numbers::pi * (outer * outer - tip_.inner * tip_.inner);
  const double length = front_length(points_.count());
  for (std::size_t k = 0; k < sectors; ++k) {
    const double angle = (2.0 * double(k) + 1.0) / double(sectors) - 1.0;  // of a half turn
    if (std::abs(angle) > slot || (is_on_plane_ && angle * above < 0.0)) continue;
    if (volumes[k] >= full * ring * length / double(sectors)) continue;
    refuse("at " + number_text(std::round(180.0 * angle)) + " degrees from the crack's direction");
  }
}

/// Length of the front by the first `points` points, as far as they are near the tip; 2D: thickness
/// [m].
double CrackTipIntegrals::front_length(Index points) const {
  if (points_.dimension == 2) return setting_.cross_section;
  const bool has_sizes = !points_.horizons.empty();
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (Index i = 0; i < points; ++i) {
    const Coordinates at = frame_.components(points_.position(i));
    if (!points_.owns(i) || std::hypot(at[0], at[1]) > tip_.outer) continue;
    const double half = has_sizes ? 0.5 * size_of_point(points_, i, setting_.cross_section) : 0.0;
    least = std::min(least, at[2] - half);
    most = std::max(most, at[2] + half);
  }
  least = -sums().largest_of_all(-least);
  most = sums().largest_of_all(most);
  return most - least + (has_sizes ? 0.0 : double(points_.spacing));
}

void CrackTipIntegrals::weigh() {
  const double width = tip_.outer - tip_.inner;
  for (Index i = 0; i < points_.count(); ++i) {
    if (!points_.owns(i)) continue;
    const Coordinates at = frame_.components(points_.position(i));
    const double r = std::hypot(at[0], at[1]);
    if (r >= tip_.outer) continue;
    Weighted weighted{i};
    for (std::size_t k = 0; k < rings; ++k) {
      const double share = k == 0 ? 1.0 : 1.0 / double(rings - 1);
      const double begin = tip_.inner + (k == 0 ? 0.0 : double(k - 1) * share * width);
      const auto [q, slope] = fall((r - begin) / (share * width));
      weighted.q[k] = q;
      weighted.slope[k] = r > 0.0 ? slope / (share * width) * at[0] / r : 0.0;
    }
    weighted_.push_back(weighted);
  }
  factor_ = (is_on_plane_ ? 2.0 : 1.0) / front_length(points_.own());
}

/// Largest horizon of the points within a distance of the tip, at least of the nearest one; each
/// image has that of its source.
double CrackTipIntegrals::largest_horizon_within(double distance) const {
  if (points_.horizons.empty()) return setting_.horizon;
  double nearest = std::numeric_limits<double>::infinity(), of_nearest = 0.0, largest = 0.0;
  for (Index i = 0; i < points_.count(); ++i) {
    if (!points_.owns(i)) continue;
    const Coordinates at = frame_.components(points_.position(i));
    const double r = std::hypot(at[0], at[1]);
    const double horizon = points_.horizons[std::size_t(points_.source(i))];
    if (r <= distance) largest = std::max(largest, horizon);
    if (r >= nearest) continue;
    nearest = r;
    of_nearest = horizon;
  }
  const double of_all = -sums().largest_of_all(-nearest);
  return sums().largest_of_all(std::max(largest, nearest == of_all ? of_nearest : 0.0));
}

/// Largest horizon in the ring and within it. The ring's default radius depends on it: the smallest
/// horizon is found that no point in its ring exceeds.
double CrackTipIntegrals::horizon_of_ring() {
  horizon_ = largest_horizon_within(0.0);
  double horizon = horizon_;
  for (double larger = 0.0;; horizon = larger) {
    const double outer =
        tip_.outer > 0.0 ? tip_.outer : std::max(outer_horizons * horizon, 2.0 * tip_.inner);
    larger = largest_horizon_within(outer);
    if (larger <= horizon) return horizon;
  }
}

double CrackTipIntegrals::largest(std::span<const double> values) const {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return sums().largest_of_all(most);
}

std::vector<Index> CrackTipIntegrals::points() const {
  std::vector<Index> within;
  for (const Weighted& weighted : weighted_) within.push_back(weighted.point);
  return within;
}

/// g = (F - I) e1 of every point, zero for handles. Planes of symmetry leave e1 as it is.
std::vector<double> CrackTipIntegrals::translation_of(Assembler& assembler,
                                                      const StateView& at) const {
  const auto d = std::size_t(points_.dimension);
  const DeformationGradients gradients = deformation_gradients(points_, assembler.model(), at);
  std::vector<double> translation(at.displacement.size(), 0.0);
  for (Index i = 0; i < points_.own(); ++i) {
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = 0; c < d; ++c) {
        translation[std::size_t(i) * d + r] +=
            gradients.displacement[(std::size_t(i) * d + r) * d + c] * frame_.e1[c];
      }
    }
  }
  setting_.index_map.update_ghosts(translation);
  for (Index image = points_.own(); image < points_.count(); ++image) {
    const ImageKind& kind = points_.image_kind(image);
    for (std::size_t r = 0; r < d; ++r) {
      translation[std::size_t(image) * d + r] =
          kind.mirror[r] * translation[std::size_t(points_.source(image)) * d + r];
    }
  }
  return translation;
}

/// J of a state, in equilibrium or not, for each ring.
CrackTipIntegrals::Rings CrackTipIntegrals::fluxes(Assembler& assembler, const StateView& at,
                                                   std::span<const double> translation) const {
  const auto d = std::size_t(points_.dimension);
  const std::size_t points = points_.volume.size();
  std::vector<double> gradient(at.displacement.size()), energy(points), ahead(points),
      behind(points);
  static_cast<void>(assembler.gradient(at, gradient));
  assembler.point_energies(at, energy);
  // Differences of energies at fields shifted by a hundredth of a spacing: energies are quadratic
  // but for rotations.
  const double step = 1e-2 * double(points_.spacing);
  std::vector<double> moved(at.displacement.begin(), at.displacement.end());
  const auto energies_after = [&](double shift, std::vector<double>& energies) {
    for (std::size_t k = 0; k < moved.size(); ++k) {
      moved[k] = at.displacement[k] + shift * translation[k];
    }
    StateView there = at;
    there.displacement = moved;
    assembler.point_energies(there, energies);
  };
  energies_after(step, ahead);
  energies_after(-step, behind);
  Rings mine{};
  for (const Weighted& weighted : weighted_) {
    const auto i = std::size_t(weighted.point);
    double along = (behind[i] - ahead[i]) / (2.0 * step);
    for (std::size_t c = 0; c < d; ++c) along += gradient[i * d + c] * translation[i * d + c];
    for (std::size_t k = 0; k < rings; ++k) {
      mine[k] += weighted.q[k] * along - weighted.slope[k] * energy[i];
    }
  }
  const std::vector<double> all = sums().of_all(std::vector(mine.begin(), mine.end()));
  Rings fluxes{};
  for (std::size_t k = 0; k < rings; ++k) fluxes[k] = factor_ * all[k];
  return fluxes;
}

/// Auxiliary displacements of all points: Williams' field of mode 0, 1 or 2, or (3) that of a force
/// on the tip.
std::vector<double> CrackTipIntegrals::field(std::size_t size, int mode) const {
  const auto d = std::size_t(points_.dimension);
  std::vector<double> displacement(size, 0.0);
  for (Index i = 0; i < points_.count(); ++i) {
    const Coordinates at = frame_.components(points_.position(i));
    const Coordinates vector =
        frame_.vector(mode < 3 ? williams_displacement(mode, at, *elasticity_)
                               : tip_force_displacement(at, *elasticity_, tip_.outer));
    for (std::size_t c = 0; c < d; ++c) displacement[std::size_t(i) * d + c] = vector[c];
  }
  return displacement;
}

/// M with an auxiliary field, over the whole ring.
double CrackTipIntegrals::interaction(Assembler& assembler, const StateView& at,
                                      std::span<const double> translation,
                                      const std::vector<double>& with) const {
  StateView auxiliary = at;
  auxiliary.displacement = with;
  const std::vector<double> its_translation = translation_of(assembler, auxiliary);
  const double size = largest(at.displacement) / largest(with);
  std::vector<double> displacement(with.size()), moving(with.size());
  const auto flux = [&](double share) {
    for (std::size_t k = 0; k < with.size(); ++k) {
      displacement[k] = at.displacement[k] + share * with[k];
      moving[k] = translation[k] + share * its_translation[k];
    }
    StateView there = at;
    there.displacement = displacement;
    return fluxes(assembler, there, moving).front();
  };
  return (flux(size) - flux(-size)) / (2.0 * size);
}

CrackTipValues CrackTipIntegrals::values(Assembler& assembler, const StateView& state) const {
  StateView at = state;
  at.damage = Damage::held;
  CrackTipValues found;
  if (largest(at.displacement) == 0.0) return found;
  const std::vector<double> translation = translation_of(assembler, at);
  const Rings j = fluxes(assembler, at, translation);
  found.j = j.front();
  for (const double part : j) {
    if (found.j != 0.0) found.spread = std::max(found.spread, std::abs(part / found.j - 1.0));
  }
  if (!elasticity_) return found;
  const TipElasticity& elasticity = *elasticity_;
  const auto with = [&](int mode) {
    return interaction(assembler, at, translation, field(at.displacement.size(), mode));
  };
  found.k[0] = 0.5 * elasticity.plane_modulus * with(0);
  // A plane of symmetry excludes fields that are antisymmetric to it.
  if (!is_on_plane_) found.k[1] = 0.5 * elasticity.plane_modulus * with(1);
  const bool has_mode_3 = points_.dimension == 3 && !is_on_plane_ && !is_front_halved_;
  if (has_mode_3) found.k[2] = elasticity.shear_modulus * with(2);
  found.t_stress = elasticity.plane_modulus * with(3);
  const double k = std::hypot(found.k[0], found.k[1]);
  if (k > 0.0) found.t_star = found.t_stress * std::sqrt(std::numbers::pi * horizon_) / k;
  return found;
}

}  // namespace peristat
