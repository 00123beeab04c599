#include "solvers/linear/surrogate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/compressed_rows.hpp"
#include "solvers/linear/worst_outcome.hpp"
#include "src/geometry/squared_distance.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/sums.hpp"

namespace peristat {
namespace {

/// Bonds up to this many nearest-neighbour distances are short: on a lattice those to the face
/// diagonals, sqrt(2) spacings long.
constexpr double short_in_spacings = 1.5;

/// Springs whose factorisation takes more than this are solved by multigrid [flop].
constexpr double largest_factorisation = 1e11;

/// Weight of block Jacobi; anything between 0.3 and 1 gives nearly the same iterations.
constexpr double share_of_jacobi = 0.5;

/// The diagonal block of a point is added if its springs have less than this fraction of the
/// point's own stiffness along an axis, because its short bonds are broken or it follows others.
constexpr double loose = 1e-3;

}  // namespace

struct Surrogate::StandIn {
  explicit StandIn(const IndexMap& of) : index_map(of) {}

  const FreeDofs* free = nullptr;
  const IndexMap& index_map;
  BlockJacobi fine{BlockJacobi::Blocks::points};
  Bonds short_bonds;
  std::vector<char> is_short;        // per bond of the pattern
  std::unique_ptr<Tangent> springs;  // null: before the first tangent
  Cholesky solver{FactorReuse{.max_iterations = 0}};
  std::optional<MatrixPreconditioner> multigrid;  // replaces the factor if set
  std::vector<double> correction;

  /// Chooses the short bonds, in the reference configuration.
  LinearOutcome choose_bonds(const TangentOperator& tangent, std::span<const double> position) {
    const BlockPattern& pattern = tangent.pattern;
    const Index points = pattern.points(), of_rank = index_map.own_rows(points);
    // Spacing at a point: mean distance of as many nearest neighbours as a lattice point has at one
    // spacing.
    constexpr std::size_t most = 6;
    const std::size_t nearest = 2 * std::size_t(tangent.dimension);
    std::vector<std::array<double, most>> distances(points);
    for (auto& list : distances) list.fill(std::numeric_limits<double>::infinity());
    const auto for_each_bond = [&](const auto& visit) {
      for (Index i = 0; i < of_rank; ++i) {
        for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
          visit(i, pattern.partner(i, bond), bond);
        }
      }
    };
    const auto insert = [&](std::array<double, most>& list, double length) {
      if (length >= list[nearest - 1]) return;
      list[nearest - 1] = length;
      std::sort(list.begin(), list.begin() + std::ptrdiff_t(nearest));
    };
    for_each_bond([&](Index i, Index j, Offset) {
      const double length = std::sqrt(squared_distance(position, tangent.dimension, i, j));
      insert(distances[i], length);
      insert(distances[j], length);
    });
    std::vector<double> spacing(points);
    for (Index i = 0; i < points; ++i) {
      double sum = 0.0;
      std::size_t count = 0;
      for (; count < nearest && std::isfinite(distances[i][count]); ++count) {
        sum += distances[i][count];
      }
      spacing[i] = count > 0 ? sum / double(count) : 0.0;
    }
    index_map.update_ghost_values(spacing);
    is_short.assign(std::size_t(pattern.blocks()), 0);
    short_bonds.offset.assign(std::size_t(points) + 1, 0);
    std::vector<Index> upper;
    for_each_bond([&](Index i, Index j, Offset bond) {
      const double limit = short_in_spacings * std::max(spacing[i], spacing[j]);
      if (squared_distance(position, tangent.dimension, i, j) > limit * limit) return;
      is_short[bond] = 1;
      upper.push_back(j);
      ++short_bonds.offset[i + 1];
    });
    for (Index i = 0; i < points; ++i) short_bonds.offset[i + 1] += short_bonds.offset[i];
    short_bonds.partner = Partners(short_bonds.offset, upper);
    springs =
        std::make_unique<Tangent>(BlockPattern(short_bonds), tangent.dimension, tangent.threads());
    multigrid.reset();
    if (!index_map.is_whole()) {  // no rank has all springs to factorise
      multigrid.emplace(MatrixPreconditionerKind::multigrid);
      return LinearOutcome::solved;
    }
    const LinearOutcome analysis = solver.analyze(springs->pattern, *free);
    if (analysis == LinearOutcome::out_of_memory ||
        solver.estimate().flops > largest_factorisation) {
      multigrid.emplace(MatrixPreconditionerKind::multigrid);
      return LinearOutcome::solved;
    }
    return analysis;
  }

  void find_springs(const TangentOperator& tangent, std::span<const double> position) {
    const BlockPattern& pattern = tangent.pattern;
    const int d = tangent.dimension, entries = d * d;
    const auto count = std::size_t(tangent.parts());
    const Index of_rank = index_map.own_rows(pattern.points());
    std::vector<double> moment(count, 0.0), short_moment(count, 0.0);
    tangent.for_each_row([&](int part, Index i, std::span<const double> blocks) {
      if (i >= of_rank) return;
      Offset spring = short_bonds.offset[i];
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const double* block = &blocks[std::size_t(bond - pattern.offset[i]) * entries];
        const Index j = pattern.partner(i, bond);
        std::array<double, 3> arm{};
        double squared = 0.0, along = 0.0;
        for (int c = 0; c < d; ++c) {
          arm[c] = position[std::size_t(j) * d + c] - position[std::size_t(i) * d + c];
          squared += arm[c] * arm[c];
        }
        for (int r = 0; r < d; ++r) {
          for (int c = 0; c < d; ++c) along -= arm[r] * block[r * d + c] * arm[c];
        }
        const double k_l2 = std::max(along, 0.0);              // k l^2
        const double share = j < of_rank ? k_l2 : 0.5 * k_l2;  // another rank has the other half
        moment[part] += share;
        if (!is_short[bond]) continue;
        short_moment[part] += share;
        double* to = &springs->off_diagonal[std::size_t(spring) * entries];
        const double scale = squared > 0.0 ? -k_l2 / (squared * squared) : 0.0;
        for (int r = 0; r < d; ++r) {
          for (int c = 0; c < d; ++c) to[r * d + c] = scale * arm[r] * arm[c];
        }
        ++spring;
      }
    });
    double all = 0.0, of_short = 0.0;
    for (const double part : moment) all += part;
    for (const double part : short_moment) of_short += part;
    const Sums sums(index_map, d);
    all = sums.of_all(all);
    of_short = sums.of_all(of_short);
    const double gamma = of_short > 0.0 ? all / of_short : 1.0;
    std::fill(springs->diagonal.begin(), springs->diagonal.end(), 0.0);
    for (Index i = 0; i < pattern.points(); ++i) {
      for (Offset spring = short_bonds.offset[i]; spring < short_bonds.offset[i + 1]; ++spring) {
        const std::size_t j = std::size_t(short_bonds.partner(i, spring));
        double* block = &springs->off_diagonal[std::size_t(spring) * entries];
        for (int k = 0; k < entries; ++k) {
          block[k] *= gamma;
          springs->diagonal[std::size_t(i) * entries + k] -= block[k];
          springs->diagonal[j * entries + k] -= block[k];
        }
      }
    }
    for (std::size_t i = 0; i < std::size_t(pattern.points()); ++i) {
      double* own = &springs->diagonal[i * entries];
      const double* whole = &tangent.diagonal[i * entries];
      bool is_loose = false;
      for (int c = 0; c < d; ++c) is_loose |= own[c * (d + 1)] < loose * whole[c * (d + 1)];
      for (int k = 0; k < entries; ++k) own[k] += (is_loose ? 1.0 : 1e-12) * whole[k];
    }
  }
};

Surrogate::Surrogate(const IndexMap& index_map) : stand_in_(std::make_unique<StandIn>(index_map)) {}
Surrogate::~Surrogate() = default;

void Surrogate::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  StandIn& s = *stand_in_;
  s.free = &free;
  s.fine.analyze(pattern, free);
  s.springs.reset();
  s.short_bonds = {};
  s.solver.count_pivots(false);
  s.correction.resize(std::size_t(free.count()));
}

LinearOutcome Surrogate::build(const TangentOperator& tangent) {
  StandIn& s = *stand_in_;
  const IndexMap& index_map = s.index_map;
  // No rank has complete rows of generalised degrees of freedom.
  if (!index_map.is_whole() && tangent.pattern.points() > index_map.count()) {
    return LinearOutcome::inaccurate;
  }
  const LinearOutcome outcome = worst_outcome(index_map.ranks(), s.fine.build(tangent));
  if (outcome != LinearOutcome::solved) return outcome;
  const std::vector<double> position = tangent.positions();
  if (!s.springs) {
    const LinearOutcome analysis = s.choose_bonds(tangent, tangent.reference);
    if (analysis != LinearOutcome::solved) return analysis;
  }
  s.find_springs(tangent, position);
  if (s.multigrid) {
    return s.multigrid->build(compressed_rows(*s.springs, *s.free, index_map),
                              equation_blocks(*s.free), rigid_motions(position, *s.free, index_map))
               ? LinearOutcome::solved
               : LinearOutcome::inaccurate;
  }
  const LinearOutcome factor = s.solver.factorize(*s.springs, FactorUse::factorize_now);
  if (factor == LinearOutcome::solved || factor == LinearOutcome::out_of_memory) return factor;
  return LinearOutcome::inaccurate;  // S is singular; the tangent need not be
}

void Surrogate::apply(std::span<const double> residual, std::span<double> correction) {
  StandIn& s = *stand_in_;
  if (s.multigrid) {
    s.multigrid->apply(residual.data(), correction.data());
    // A valid factor always solves; the outer iteration corrects its inaccuracy.
  } else if (s.solver.solve(residual, correction, 1.0) == LinearOutcome::out_of_memory) {
    std::fill(correction.begin(), correction.end(), 0.0);
  }
  s.fine.add(share_of_jacobi, residual, correction);
}

std::string Surrogate::describe() const {
  const StandIn& s = *stand_in_;
  if (s.short_bonds.offset.empty()) return "surrogate";
  const double points = double(std::max<std::size_t>(s.short_bonds.offset.size(), 2) - 1);
  return fmt::format("surrogate of {:.1f} neighbours per point ({})",
                     2.0 * double(s.short_bonds.count()) / points,
                     s.multigrid ? "multigrid" : s.solver.describe());
}

}  // namespace peristat
