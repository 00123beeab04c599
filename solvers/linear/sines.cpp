#include "solvers/linear/sines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/transforms/good_size.hpp"
#include "src/transforms/trigonometric_transform.hpp"

namespace peristat {
namespace {

/// An end of the box is held if the plane of sites beyond it has at least this many prescribed
/// degrees of freedom for each free one in the plane before it.
constexpr double held_share = 0.5;

/// A mean stiffness against translations below this fraction of the stencil's is round-off.
constexpr double no_translation = 1e-10;

/// Lower limit of the symbol, as a fraction of that of nearest-neighbour springs with the same
/// stiffness for long waves: in a deformed state it may vanish where the tangent does not.
constexpr double least_share = 0.01;

using Numbers = std::array<Index, 3>;

/// Sums over pairs of points, by the absolute values of their offsets along the axes, 0 ... reach.
struct Stencil {
  Numbers size{1, 1, 1};    // reach + 1
  std::vector<double> sum;  // by offset, for each component

  void clear(const Numbers& reach, int components) {
    for (int a = 0; a < 3; ++a) size[a] = reach[a] + 1;
    sum.assign(count() * std::size_t(components), 0.0);
  }
  [[nodiscard]] std::size_t count() const {
    return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
  }
  [[nodiscard]] std::size_t place(const Numbers& a, const Numbers& b) const {
    const auto apart = [&](int c) { return std::size_t(std::abs(a[c] - b[c])); };
    return (apart(0) * std::size_t(size[1]) + apart(1)) * std::size_t(size[2]) + apart(2);
  }
};

/// Box around the equations of one component of the displacement.
struct Component {
  Numbers first{}, extent{1, 1, 1};
  std::array<RowEnd, 3> below{}, above{};
  std::vector<float> inverse;  // inverse of the symbol, by mode

  [[nodiscard]] std::size_t place(const Numbers& at) const {
    return (std::size_t(at[0] - first[0]) * std::size_t(extent[1]) +
            std::size_t(at[1] - first[1])) *
               std::size_t(extent[2]) +
           std::size_t(at[2] - first[2]);
  }
  [[nodiscard]] std::vector<TransformAxis> axes(int dimension) const {
    std::vector<TransformAxis> axes;
    for (int a = 0; a < dimension; ++a) axes.push_back({extent[a], below[a], above[a]});
    return axes;
  }
};

}  // namespace

struct Sines::Symbols {
  std::shared_ptr<const LatticeBox> box;
  const FreeDofs* free = nullptr;
  int dimension = 0, threads = 1;
  Numbers reach{};  // of the pattern, in lattice sites
  std::vector<Component> components;
  std::vector<TrigonometricTransform> transforms;  // distinct ones
  std::vector<std::size_t> transform_of;           // by component

  [[nodiscard]] bool is_free(Index point, int component) const {
    return free->equation[std::size_t(point) * std::size_t(dimension) + std::size_t(component)] !=
           FreeDofs::none;
  }

  void find_reach(const BlockPattern& pattern) {
    reach = {};
    for (Index i = 0; i < pattern.points(); ++i) {
      const Numbers at = box->numbers(box->place[std::size_t(i)]);
      for (const Index j : pattern.of(i)) {
        const Numbers other = box->numbers(box->place[std::size_t(j)]);
        for (int a = 0; a < 3; ++a) reach[a] = std::max(reach[a], std::abs(other[a] - at[a]));
      }
    }
  }

  /// Finds the box of a component's equations, and which of its ends supports hold.
  Component find_component(int c) const {
    Component result;
    Numbers last{-1, -1, -1};
    result.first.fill(std::numeric_limits<Index>::max());
    const auto points = static_cast<Index>(box->place.size());
    for (Index i = 0; i < points; ++i) {
      if (!is_free(i, c)) continue;
      const Numbers at = box->numbers(box->place[std::size_t(i)]);
      for (int a = 0; a < 3; ++a) {
        result.first[a] = std::min(result.first[a], at[a]);
        last[a] = std::max(last[a], at[a]);
      }
    }
    if (last[0] < 0) {  // all prescribed
      result.first.fill(0);
      return result;
    }
    for (int a = 0; a < 3; ++a) result.extent[a] = last[a] - result.first[a] + 1;
    std::array<std::array<double, 2>, 3> free_in{}, held_beyond{};
    for (Index i = 0; i < points; ++i) {
      const Numbers at = box->numbers(box->place[std::size_t(i)]);
      const bool is_held = !is_free(i, c);
      for (int a = 0; a < dimension; ++a) {
        if (is_held) {
          held_beyond[a][0] += at[a] == result.first[a] - 1;
          held_beyond[a][1] += at[a] == last[a] + 1;
        } else {
          free_in[a][0] += at[a] == result.first[a];
          free_in[a][1] += at[a] == last[a];
        }
      }
    }
    const auto end = [&](int a, int side) {
      return held_beyond[a][side] >= held_share * free_in[a][side] ? RowEnd::held : RowEnd::free;
    };
    for (int a = 0; a < dimension; ++a) {
      result.below[a] = end(a, 0);
      result.above[a] = end(a, 1);
      // Extends beyond a free side rather than into a support.
      const Index more = good_size(result.extent[a]) - result.extent[a];
      const bool goes_below = result.below[a] == RowEnd::free && result.above[a] == RowEnd::held;
      if (goes_below) result.first[a] -= more;
      result.extent[a] += more;
    }
    return result;
  }

  /// Makes the transforms; components with the same box and ends share one.
  void plan() {
    transforms.clear();
    transform_of.clear();
    for (const Component& component : components) {
      const std::vector<TransformAxis> axes = component.axes(dimension);
      const auto same = std::find_if(transforms.begin(), transforms.end(),
                                     [&](const auto& known) { return known.axes() == axes; });
      transform_of.push_back(std::size_t(same - transforms.begin()));
      if (same == transforms.end()) transforms.emplace_back(axes, threads);
    }
  }

  /// Returns the sums of a tangent that provides its stencil itself.
  Stencil sums(const LatticeStencil& of_tangent) {
    reach = {};
    const auto apart = [](const StencilEntry& entry) {
      return Numbers{std::abs(entry.step[0]), std::abs(entry.step[1]), std::abs(entry.step[2])};
    };
    for (const StencilEntry& entry : of_tangent) {
      for (std::size_t a = 0; a < 3; ++a) reach[a] = std::max(reach[a], apart(entry)[a]);
    }
    Stencil all;
    all.clear(reach, dimension);
    for (const StencilEntry& entry : of_tangent) {
      const std::size_t place = all.place(apart(entry), {}) * std::size_t(dimension);
      for (std::size_t c = 0; c < std::size_t(dimension); ++c) all.sum[place + c] += entry.sum[c];
    }
    return all;
  }

  /// Returns minus the sums of the tangent's diagonal components over pairs of points.
  Stencil sums(const TangentOperator& tangent) {
    if (const LatticeStencil told = tangent.stencil(); !told.empty()) return sums(told);
    const int d = dimension;
    const BlockPattern& pattern = tangent.pattern;
    std::vector<Stencil> parts(std::size_t(tangent.parts()));
    for (Stencil& part : parts) part.clear(reach, d);
    tangent.for_each_row([&](int part, Index i, std::span<const double> blocks) {
      Stencil& of_part = parts[std::size_t(part)];
      const Numbers at = box->numbers(box->place[std::size_t(i)]);
      const double* block = blocks.data();
      for (const Index j : pattern.of(i)) {
        const std::size_t place =
            of_part.place(at, box->numbers(box->place[std::size_t(j)])) * std::size_t(d);
        for (int c = 0; c < d; ++c) of_part.sum[place + std::size_t(c)] -= block[c * (d + 1)];
        block += d * d;
      }
    });
    Stencil all = std::move(parts.front());
    for (std::size_t t = 1; t < parts.size(); ++t) {
      for (std::size_t k = 0; k < all.sum.size(); ++k) all.sum[k] += parts[t].sum[k];
    }
    return all;
  }

  LinearOutcome find_symbols(const TangentOperator& tangent);
};

namespace {

/// Mean stencil of one component: the weights w(o) of offsets o >= 0, so that S(k) = s + sum_o w (1
/// - prod cos); each includes the offsets with other signs.
struct MeanStencil {
  Numbers size{1, 1, 1};
  std::vector<double> weight;
  double translation = 0.0;            // s
  std::array<double, 3> long_waves{};  // sum_o |w| o_a^2

  MeanStencil(const Stencil& sums, int component, int dimension, double of_diagonals,
              double points) {
    size = sums.size;
    const auto d = std::size_t(dimension);
    double total = 0.0, magnitude = 0.0;
    for (std::size_t k = 0; k < sums.count(); ++k) {
      const double sum = sums.sum[k * d + std::size_t(component)];
      total += sum;
      const std::size_t n1 = std::size_t(size[1]), n2 = std::size_t(size[2]);
      const std::array<std::size_t, 3> offset{k / n2 / n1, k / n2 % n1, k % n2};
      weight.push_back(2.0 * sum / points);
      magnitude += std::abs(weight.back());
      for (int a = 0; a < 3; ++a) {
        long_waves[a] += std::abs(weight.back()) * double(offset[a]) * double(offset[a]);
      }
    }
    translation = (of_diagonals - 2.0 * total) / points;
    if (!(translation > no_translation * magnitude)) translation = 0.0;
  }

  [[nodiscard]] bool is_stiff() const {
    double all = translation;
    for (const double of_axis : long_waves) all += of_axis;
    return std::isfinite(all) && all > 0.0;
  }
};

/// Returns the cosines of an axis' modes at the offsets of the stencil: modes x size.
std::vector<double> cosines(const TransformAxis& axis, Index size) {
  std::vector<double> result;
  for (Index mode = 0; mode < axis.count; ++mode) {
    for (Index o = 0; o < size; ++o) result.push_back(std::cos(axis.wave_number(mode) * double(o)));
  }
  return result;
}

/// Returns 1 / (factor S) for each mode of a box.
std::vector<float> inverse_symbol(const MeanStencil& of, std::vector<TransformAxis> axes,
                                  double factor, int threads) {
  axes.resize(3);
  std::array<std::vector<double>, 3> cosine;
  for (std::size_t a = 0; a < 3; ++a) cosine[a] = cosines(axes[a], of.size[a]);
  const auto [n0, n1, n2] = std::array{axes[0].count, axes[1].count, axes[2].count};
  const std::size_t r0 = std::size_t(of.size[0]), r1 = std::size_t(of.size[1]),
                    r2 = std::size_t(of.size[2]);
  double all = of.translation;
  for (const double weight : of.weight) all += weight;
  std::vector<float> inverse(std::size_t(n0) * std::size_t(n1) * std::size_t(n2));
  const auto at = [&](Index i, Index j, Index k) -> float& {
    return inverse[(std::size_t(i) * std::size_t(n1) + std::size_t(j)) * std::size_t(n2) +
                   std::size_t(k)];
  };
  const auto springs = [&](std::size_t axis, Index mode) {
    return 2.0 * of.long_waves[axis] * (0.5 - 0.5 * std::cos(axes[axis].wave_number(mode)));
  };
#pragma omp parallel for num_threads(threads) schedule(static)
  for (Index i = 0; i < n0; ++i) {
    // The sums are done axis by axis: over the offsets along the first, then the second, then the
    // third.
    std::vector<double> plane(r1 * r2, 0.0), row(r2);
    for (std::size_t o = 0; o < r0; ++o) {
      const double wave = cosine[0][std::size_t(i) * r0 + o];
      for (std::size_t p = 0; p < r1 * r2; ++p) plane[p] += wave * of.weight[o * r1 * r2 + p];
    }
    for (Index j = 0; j < n1; ++j) {
      std::fill(row.begin(), row.end(), 0.0);
      for (std::size_t o = 0; o < r1; ++o) {
        const double wave = cosine[1][std::size_t(j) * r1 + o];
        for (std::size_t p = 0; p < r2; ++p) row[p] += wave * plane[o * r2 + p];
      }
      for (Index k = 0; k < n2; ++k) {
        double symbol = all;
        for (std::size_t o = 0; o < r2; ++o) symbol -= cosine[2][std::size_t(k) * r2 + o] * row[o];
        const double least = least_share * (springs(0, i) + springs(1, j) + springs(2, k));
        at(i, j, k) = static_cast<float>(1.0 / (factor * std::max(symbol, least)));
      }
    }
  }
  // If no side of the box is held, the constant mode has a zero symbol: it gets the inverse symbol
  // of the longest wave.
  if (!std::isfinite(at(0, 0, 0))) {
    float longest = 0.0F;
    if (n0 > 1) longest = std::max(longest, at(1, 0, 0));
    if (n1 > 1) longest = std::max(longest, at(0, 1, 0));
    if (n2 > 1) longest = std::max(longest, at(0, 0, 1));
    at(0, 0, 0) = longest > 0.0F ? longest : 1.0F;
  }
  return inverse;
}

}  // namespace

LinearOutcome Sines::Symbols::find_symbols(const TangentOperator& tangent) {
  const Stencil stencil = sums(tangent);
  const double points = double(box->place.size());
  for (int c = 0; c < dimension; ++c) {
    double of_diagonals = 0.0;
    const std::size_t entries = std::size_t(dimension) * std::size_t(dimension);
    for (std::size_t i = 0; i < box->place.size(); ++i) {
      of_diagonals += tangent.diagonal[i * entries + std::size_t(c * (dimension + 1))];
    }
    const MeanStencil mean(stencil, c, dimension, of_diagonals, points);
    if (!mean.is_stiff()) return LinearOutcome::inaccurate;
    const TrigonometricTransform& transform = transforms[transform_of[std::size_t(c)]];
    components[std::size_t(c)].inverse =
        inverse_symbol(mean, transform.axes(), transform.factor(), threads);
  }
  return LinearOutcome::solved;
}

Sines::Sines(std::shared_ptr<const LatticeBox> box) : symbols_(std::make_unique<Symbols>()) {
  symbols_->box = std::move(box);
}
Sines::~Sines() = default;

void Sines::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  Symbols& symbols = *symbols_;
  symbols.dimension = symbols.box->dimension;
  if (free.dimension != symbols.dimension ||
      free.equation.size() != symbols.box->place.size() * std::size_t(free.dimension)) {
    throw std::logic_error("sines are for degrees of freedom of the lattice's points alone");
  }
  symbols.free = &free;
  symbols.transforms.clear();
  symbols.find_reach(pattern);
  symbols.components.clear();
  for (int c = 0; c < symbols.dimension; ++c) {
    symbols.components.push_back(symbols.find_component(c));
  }
}

LinearOutcome Sines::build(const TangentOperator& tangent) {
  Symbols& symbols = *symbols_;
  if (symbols.transforms.empty() || symbols.threads != tangent.threads()) {
    symbols.threads = tangent.threads();
    symbols.plan();
  }
  return symbols.find_symbols(tangent);
}

void Sines::apply(std::span<const double> residual, std::span<double> correction) {
  Symbols& symbols = *symbols_;
  const auto d = std::size_t(symbols.dimension);
  const auto points = static_cast<std::ptrdiff_t>(symbols.box->place.size());
  for (std::size_t c = 0; c < d; ++c) {
    const Component& component = symbols.components[c];
    TrigonometricTransform& transform = symbols.transforms[symbols.transform_of[c]];
    const std::span<double> values = transform.values();
    const auto for_each_equation = [&](const auto& visit) {
#pragma omp parallel for num_threads(symbols.threads) schedule(static)
      for (std::ptrdiff_t i = 0; i < points; ++i) {
        const Index e = symbols.free->equation[std::size_t(i) * d + c];
        if (e == FreeDofs::none) continue;
        visit(e, component.place(symbols.box->numbers(symbols.box->place[std::size_t(i)])));
      }
    };
    const auto modes = static_cast<std::ptrdiff_t>(values.size());
#pragma omp parallel for num_threads(symbols.threads) schedule(static)
    for (std::ptrdiff_t k = 0; k < modes; ++k) values[std::size_t(k)] = 0.0;
    for_each_equation([&](Index e, std::size_t place) { values[place] = residual[e]; });
    transform.to_modes();
#pragma omp parallel for num_threads(symbols.threads) schedule(static)
    for (std::ptrdiff_t k = 0; k < modes; ++k) {
      values[std::size_t(k)] *= double(component.inverse[std::size_t(k)]);
    }
    transform.to_places();
    for_each_equation([&](Index e, std::size_t place) { correction[e] = values[place]; });
  }
}

std::string Sines::describe() const {
  const Numbers& extent = symbols_->box->extent;
  std::string size = std::to_string(extent[0]);
  for (int a = 1; a < symbols_->box->dimension; ++a) size += " x " + std::to_string(extent[a]);
  return "sines on " + size + " places";
}

}  // namespace peristat
