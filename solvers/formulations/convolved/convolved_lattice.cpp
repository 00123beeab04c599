#include "solvers/formulations/convolved/convolved_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include "assembly/convolutions/lattice_springs.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/lattice_box.hpp"
#include "src/geometry/lattice_frame.hpp"

namespace peristat {
namespace {

/// Tolerance of a point's distance from its lattice site, in spacings, and relative one of a
/// volume.
constexpr double lattice_tolerance = 1e-9;

[[noreturn]] void refuse_convolution(OtherOperator other, const std::string& why) {
  throw InputError("force_operator", "fft",
                   other == OtherOperator::none ? why + "; this model has no other operator"
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
LatticeBox box_of(const BodySpecification& from, const Points& points, OtherOperator other) {
  if (!from.is_uniform()) {
    refuse_convolution(other,
                       "is for bodies of one material: with regions, fibres or random fields the "
                       "stiffness of a bond does not depend on its lattice vector alone");
  }
  if (from.surface_correction != SurfaceCorrection::none) {
    refuse_convolution(
        other, "is not allowed with a surface_correction, which has a factor for each bond");
  }
  if (points.own() < points.count()) {
    if (!from.cracks.empty()) {
      refuse_convolution(other,
                         "is not allowed with pre-cracks beside planes of symmetry or periods");
    }
    if (from.form == SolidForm::printed) {
      refuse_convolution(other,
                         "with the form printed is not allowed with planes of symmetry and "
                         "periods, across which forces without a potential have no image");
    }
  }
  if (!points.neighbours.empty()) refuse_convolution(other, "finds its neighbours by itself");
  std::string why_not;
  std::optional<LatticeBox> box = lattice_box(points, why_not);
  if (!box) refuse_convolution(other, "needs points on a lattice: " + why_not);
  if (!stand_in_place(points)) {
    refuse_convolution(other, "needs points at the sites of the lattice");
  }
  const auto [least, most] = std::minmax_element(points.volume.begin(), points.volume.end());
  if (*most - *least > lattice_tolerance * *most) {
    refuse_convolution(other, "needs points of equal volume, that of a cell");
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
    const Coordinates a = part.position(i), b = part.position(bonds.partner(i, bond));
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
  std::vector<Index> upper;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (const Index j : bonds.of(i)) upper.push_back(near[std::size_t(j)]);
  }
  result.partner = Partners(result.offset, upper);
  result.kind = std::move(bonds.kind);
  return result;
}

CutBonds told(const Bonds& bonds) {
  CutBonds cut{std::vector<double>(std::size_t(bonds.points()), 0.0), {}};
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      cut.weight[std::size_t(i)] += bonds.weight(bond);
      cut.weight[std::size_t(j)] += bonds.weight(bond);
      cut.ends.push_back({i, j});
    }
  }
  return cut;
}

}  // namespace

void require_convolutions(const BodySpecification& from, const Points& points) {
  static_cast<void>(box_of(from, points, OtherOperator::bonds));
}

BondSetting setting_of_short_bonds(const Points& points, BondSetting setting) {
  std::array<double, 3> edge{};
  for (int c = 0; c < points.dimension; ++c) edge[std::size_t(c)] = points.spacing.along(c);
  std::ranges::sort(edge, std::greater<>());
  constexpr double beyond = 1.01;  // includes the diagonal itself
  setting.horizon = std::min(setting.horizon, beyond * std::hypot(edge[0], edge[1]));
  setting.shape = HorizonShape::ball;
  setting.volume_correction = VolumeCorrection::none;
  return setting;
}

ConvolvedLattice make_convolved_lattice(const ModelSetting& setting, const BondSetting& of_springs,
                                        double modulus, CutBonds& cut, OtherOperator other) {
  const BodySpecification& from = setting.of;
  const Points& points = setting.points;
  const int threads = setting.threads;
  ConvolvedLattice lattice;
  lattice.box = box_of(from, points, other);
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

void cut_short_bonds(Bonds& bonds, const ModelSetting& setting) {
  if (setting.points.own() < setting.points.count()) drop_weightless(bonds);
  static_cast<void>(cut_bonds(bonds, setting.points, setting.of.cracks));
}

}  // namespace peristat
