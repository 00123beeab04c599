#include "assembly/terms/pressure/pressure_term.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Vector3 = Vector<3, double>;
using Block = Matrix<3, double>;

/// An element at a state: its corners, and the factor of their cross products.
class ElementAt {
 public:
  ElementAt(const PressureTerm& term, const PressureTerm::Element& element, const StateView& at)
      : dimension_(term.points().dimension), corners_(dimension_) {
    const PressedBoundary& boundary = term.boundary();
    const double pressure = at.environment->pressure[std::size_t(element.face)];
    pressure_ = pressure * element.share * boundary.cross_section;
    sign_ = boundary.sign[std::size_t(element.face)];
    for (int k = 0; k < corners_; ++k) {
      const auto corner = std::size_t(element.corner[k]);
      const std::vector<Index>& adjacent = boundary.adjacent[corner];
      place_[k] = boundary.corner[corner];
      const std::vector<double>& weights = term.weights(element.corner[k]);
      for (std::size_t p = 0; p < adjacent.size(); ++p) {
        for (int c = 0; c < dimension_; ++c) {
          place_[k][c] += weights[p] * at.displacement[std::size_t(adjacent[p]) * dimension_ + c];
        }
      }
    }
  }

  [[nodiscard]] int corners() const { return corners_; }

  /// Minus the force at each corner: p A n / corners.
  [[nodiscard]] Vector3 pull() const {
    if (dimension_ == 1) return {pressure_ * sign_, 0.0, 0.0};
    const Vector3 d = minus<3>(place_[1], place_[0]);
    if (dimension_ == 2) return {0.5 * pressure_ * d[1], -0.5 * pressure_ * d[0], 0.0};
    return scaled<3>(pressure_ / 6.0, cross(d, minus<3>(place_[2], place_[0])));
  }

  /// Its derivative with respect to a corner, the same at all corners.
  [[nodiscard]] Block derivative(int corner) const {
    Block block{};
    if (dimension_ == 2) {
      const double half = (corner == 0 ? -0.5 : 0.5) * pressure_;
      block[0][1] = half;
      block[1][0] = -half;
    } else if (dimension_ == 3) {
      const Vector3 opposite = minus<3>(place_[(corner + 2) % 3], place_[(corner + 1) % 3]);
      add_skew<double>(pressure_ / 6.0, opposite, block);
    }
    return block;
  }

  /// Symmetric part of the derivative of the pull at one corner with respect to another.
  /// Derivatives are skew: K_yx^T is minus that with respect to x.
  [[nodiscard]] Block symmetric(int of, int with) const {
    return combined(derivative(with), derivative(of), -1.0);
  }
  /// The unsymmetric rest.
  [[nodiscard]] Block unsymmetric(int of, int with) const {
    return combined(derivative(with), derivative(of), 1.0);
  }

 private:
  static Block combined(const Block& a, const Block& b, double sign) {
    Block mean{};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) mean[r][c] = 0.5 * (a[r][c] + sign * b[r][c]);
    }
    return mean;
  }

  int dimension_, corners_;
  double pressure_ = 0.0, sign_ = 1.0;
  std::array<Vector3, 3> place_{};
};

/// Calls visit(corner, corner, point, point, share) for all pairs of points of an element.
template <class Visit>
void for_each_pair(const PressureTerm& term, const PressureTerm::Element& element,
                   const Visit& visit) {
  const int corners = term.points().dimension;
  const auto& adjacent = term.boundary().adjacent;
  for (int x = 0; x < corners; ++x) {
    const std::vector<Index>& of_x = adjacent[std::size_t(element.corner[x])];
    const std::vector<double>& weights_x = term.weights(element.corner[x]);
    for (int y = 0; y < corners; ++y) {
      const std::vector<Index>& of_y = adjacent[std::size_t(element.corner[y])];
      const std::vector<double>& weights_y = term.weights(element.corner[y]);
      for (std::size_t p = 0; p < of_x.size(); ++p) {
        for (std::size_t q = 0; q < of_y.size(); ++q) {
          visit(x, y, of_x[p], of_y[q], weights_x[p] * weights_y[q]);
        }
      }
    }
  }
}

/// The smallest weights that are exact for linear fields: sum w = 1, sum w (X - corner) = 0. With A
/// the matrix of these sums w = A^T (A A^T)^-1 (1, 0, 0, 0), solved by elimination with positions
/// in units of the spacing.
std::vector<double> linear_weights(const Points& points, const std::vector<Index>& around,
                                   const Coordinates& corner) {
  constexpr double singular = 1e-6;  // of a matrix of whole and half numbers
  const int size = points.dimension + 1;
  std::vector<std::array<double, 4>> columns;
  for (const Index point : around) {
    const Coordinates at = points.position(point);
    std::array<double, 4> column{1.0};
    for (int c = 0; c < points.dimension; ++c) {
      column[std::size_t(c) + 1] = (at[c] - corner[c]) / points.spacing;
    }
    columns.push_back(column);
  }
  std::array<std::array<double, 5>, 4> rows{};
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < size; ++c) {
      for (const auto& column : columns) rows[r][c] += column[r] * column[c];
    }
  }
  rows[0][4] = 1.0;
  for (int pivot = 0; pivot < size; ++pivot) {  // symmetric and positive definite: no exchanges
    if (!(rows[pivot][pivot] > singular)) {
      throw InputError("loads", "",
                       "a pressure needs a body at least two points thick, but at " +
                           place_text(corner, points.dimension) + " m there is only one");
    }
    for (int r = 0; r < size; ++r) {
      if (r == pivot) continue;
      const double factor = rows[r][pivot] / rows[pivot][pivot];
      for (int c = 0; c < 5; ++c) rows[r][c] -= factor * rows[pivot][c];
    }
  }
  std::vector<double> weights;
  for (const auto& column : columns) {
    double weight = 0.0;
    for (int r = 0; r < size; ++r) weight += column[r] * rows[r][4] / rows[r][r];
    weights.push_back(weight);
  }
  return weights;
}

/// (A^T B C)_rc
double folded_entry(const Block& a, const Block& b, const Block& c, std::size_t row,
                    std::size_t column) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t l = 0; l < 3; ++l) sum += a[k][row] * b[k][l] * c[l][column];
  }
  return sum;
}

bool acts(const StateView& at) { return at.environment && !at.environment->pressure.empty(); }

class PressurePasses : public TermPasses, BlockTangent {
 public:
  PressurePasses(const PressureTerm& term, const TermSetting& setting)
      : term_(term), places_(setting.pattern.places_of(term.couplings())) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::fill(gradient.begin(), gradient.end(), 0.0);
    if (!gradient.empty()) add_pulls(at, 1.0, gradient);
    return {};
  }

  void follower_force(const StateView& at, std::span<double> force) override {
    add_pulls(at, -1.0, force);
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  /// Projection removes the load stiffness, which has no definite part of its own.
  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (how == Write::over) tangent.clear();
    if (!acts(at)) return;
    const auto d = std::size_t(tangent.dimension);
    std::vector<double> entries(d * d);
    for (const PressureTerm::Element& element : term_.elements()) {
      const ElementAt there(term_, element, at);
      for_each_pair(term_, element, [&](int x, int y, Index i, Index j, double share) {
        if (x == y || i > j) return;
        const Block block = there.symmetric(x, y);
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) {
            entries[r * d + c] = (1.0 - projection) * share * block[r][c];
            if (i == j) tangent.diagonal[std::size_t(i) * d * d + r * d + c] += entries[r * d + c];
          }
        }
        if (i < j) tangent.add_to_block(place(i, j), entries);
      });
    }
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (how == Write::over) std::fill(product.begin(), product.end(), 0.0);
    if (!acts(at)) return;
    const auto d = std::size_t(term_.points().dimension);
    for (const PressureTerm::Element& element : term_.elements()) {
      const ElementAt there(term_, element, at);
      for_each_pair(term_, element, [&](int x, int y, Index i, Index j, double share) {
        if (x == y) return;
        const Block block = there.symmetric(x, y);
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) {
            product[std::size_t(i) * d + r] +=
                (1.0 - projection) * share * block[r][c] * v[std::size_t(j) * d + c];
          }
        }
      });
    }
  }

  void point_energies(const StateView&, std::span<double> energies, Write how) override {
    if (how == Write::over) std::fill(energies.begin(), energies.end(), 0.0);
  }

 private:
  void add_pulls(const StateView& at, double factor, std::span<double> to) const {
    if (!acts(at)) return;
    const auto d = std::size_t(term_.points().dimension);
    for (const PressureTerm::Element& element : term_.elements()) {
      const ElementAt there(term_, element, at);
      const Vector3 pull = there.pull();
      for (int k = 0; k < there.corners(); ++k) {
        const auto& adjacent = term_.boundary().adjacent[std::size_t(element.corner[k])];
        const std::vector<double>& weights = term_.weights(element.corner[k]);
        for (std::size_t p = 0; p < adjacent.size(); ++p) {
          for (std::size_t c = 0; c < d; ++c) {
            to[std::size_t(adjacent[p]) * d + c] += factor * weights[p] * pull[c];
          }
        }
      }
    }
  }

  [[nodiscard]] Offset place(Index i, Index j) const {
    const Offset number = term_.couplings().find(i, j).value();
    return places_.empty() ? number : places_[std::size_t(number)];
  }

  const PressureTerm& term_;
  std::vector<Offset> places_;
};

}  // namespace

PressureTerm::PressureTerm(const Points& points, PressedBoundary boundary)
    : points_(points), boundary_(std::move(boundary)) {
  for (std::size_t k = 0; k < boundary_.corner.size(); ++k) {
    weights_.push_back(linear_weights(points, boundary_.adjacent[k], boundary_.corner[k]));
  }
  for (std::size_t f = 0; f < boundary_.face.size(); ++f) {
    const auto& [a, b, c, d] = boundary_.face[f];
    const auto number = Index(f);
    if (points.dimension < 3) {
      elements_.push_back({{a, b, 0}, number, 1.0});
      continue;
    }
    for (const std::array<Index, 3>& triangle :
         {std::array{a, b, c}, std::array{a, c, d}, std::array{a, b, d}, std::array{b, c, d}}) {
      if (triangle[1] != triangle[2]) elements_.push_back({triangle, number, 0.5});
    }
  }
  std::vector<std::set<Index>> rows(std::size_t(points.count()));
  for (const Element& element : elements_) {
    for_each_pair(*this, element, [&](int, int, Index i, Index j, double) {
      if (i < j) rows[std::size_t(i)].insert(j);
    });
  }
  offset_.push_back(0);
  PartnersBuilder partners;
  for (const std::set<Index>& row : rows) {
    partners.add(row);
    offset_.push_back(offset_.back() + Offset(row.size()));
  }
  partner_ = partners.take();
}

std::unique_ptr<TermPasses> PressureTerm::passes(const TermSetting& setting) const {
  return std::make_unique<PressurePasses>(*this, setting);
}

double PressureTerm::area() const {
  const std::vector<double> unit_pressure(boundary_.face.size(), 1.0);
  const std::vector<double> forces = face_forces(boundary_, unit_pressure, points_.dimension);
  const auto d = std::size_t(points_.dimension);
  double sum = 0.0;
  for (std::size_t k = 0; k < forces.size(); k += d) {
    double squared = 0.0;
    for (std::size_t c = 0; c < d; ++c) squared += forces[k + c] * forces[k + c];
    sum += std::sqrt(squared);
  }
  return sum;
}

PressureTerm::Stiffness PressureTerm::stiffness(const StateView& at, const Constraints& constraints,
                                                const std::vector<char>& prescribed) const {
  const auto d = std::size_t(points_.dimension);
  std::map<std::pair<std::size_t, std::size_t>, std::array<double, 2>> entries;  // of J^T K J
  const auto add = [&](const Dependence& row, const Dependence& column, double share,
                       const Block& block, std::size_t part) {
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = 0; c < d; ++c) {
        const std::size_t i = std::size_t(row.master) * d + r,
                          j = std::size_t(column.master) * d + c;
        if (!prescribed[i] && !prescribed[j]) {
          entries[{i, j}][part] += share * folded_entry(row.block, block, column.block, r, c);
        }
      }
    }
  };
  for (const Element& element : elements_) {
    const ElementAt there(*this, element, at);
    for_each_pair(*this, element, [&](int x, int y, Index i, Index j, double share) {
      for (const Dependence& row : constraints.dependences(i, at.displacement)) {
        for (const Dependence& column : constraints.dependences(j, at.displacement)) {
          add(row, column, share, there.symmetric(x, y), 0);
          add(row, column, share, there.unsymmetric(x, y), 1);
        }
      }
    });
  }
  std::array<double, 2> sums{};
  for (const auto& [place, parts] : entries) {
    for (std::size_t part = 0; part < 2; ++part) sums[part] += parts[part] * parts[part];
  }
  return {std::sqrt(sums[0]), std::sqrt(sums[1])};
}

}  // namespace peristat
