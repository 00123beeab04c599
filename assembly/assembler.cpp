#include "assembly/assembler.hpp"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "assembly/bond_kernels.hpp"
#include "assembly/damage.hpp"
#include "assembly/local_kernels.hpp"
#include "assembly/workspace.hpp"
#include "src/stopwatch.hpp"

namespace peristat {
namespace {

/// Calls body with the dimension as a compile-time constant and the potential as its own type.
template <class Body>
auto dispatch(int dimension, const BondPotential& potential, const Body& body) {
  return std::visit(
      [&](const auto& law) {
        switch (dimension) {
          case 1:
            return body(std::integral_constant<int, 1>{}, law);
          case 2:
            return body(std::integral_constant<int, 2>{}, law);
          default:
            return body(std::integral_constant<int, 3>{}, law);
        }
      },
      potential);
}

/// Calls body with the dimension as a compile-time constant, for models with more than bonds.
template <class Body>
void with_dimension(int dimension, const Body& body) {
  if (dimension == 2) body(std::integral_constant<int, 2>{});
  if (dimension == 3) body(std::integral_constant<int, 3>{});
}

bool has_damage(const Model& model) {
  return std::visit([]<class P>(const P&) { return PotentialWithHistory<P>; }, model.potential);
}

template <class Term>
bool is_negative(const std::optional<Term>& term) {
  return term && std::visit([](const auto& law) { return law.modulus < 0.0; }, term->potential);
}

}  // namespace

Assembler::Assembler(const Points& points, const Model& model, int threads)
    : workspace_(std::make_unique<Workspace>(points, model, threads)) {
  if (has_damage(model) && (is_negative(model.triangles) || is_negative(model.tetrahedra))) {
    throw std::logic_error("what is lost with a bond must not hold negative energy");
  }
}
Assembler::~Assembler() = default;

int Assembler::threads() const { return workspace_->threads(); }
const Points& Assembler::points() const { return workspace_->points; }
const Model& Assembler::model() const { return workspace_->model; }

Stored Assembler::energy(std::span<const double> displacement) {
  return gradient(displacement, {});
}

Stored Assembler::gradient(std::span<const double> displacement, std::span<double> gradient) {
  return pass<false>(displacement, gradient);
}

Stored Assembler::commit(std::span<const double> displacement, std::span<double> gradient) {
  return pass<true>(displacement, gradient);
}

template <bool commits>
Stored Assembler::pass(std::span<const double> displacement, std::span<double> gradient) {
  const Stopwatch watch(seconds_);
  const int dimension = points().dimension;
  Stored stored = dispatch(dimension, workspace_->potential, [&]<class P>(auto d, const P& law) {
    constexpr bool moves_history = commits && PotentialWithHistory<P>;
    return BondKernels<decltype(d)::value>::template gradient<moves_history>(
        *workspace_, law, displacement, gradient);
  });
  if (model().has_only_bonds()) return stored;
  with_dimension(dimension, [&](auto d) {
    using Kernels = LocalKernels<decltype(d)::value>;
    if (stored.growth.degrading > 0) {
      stored.released = Kernels::gradient(*workspace_, displacement, {}).energy;
      workspace_->find_integrity();
    }
    const Stored higher = Kernels::gradient(*workspace_, displacement, gradient);
    // No integrity rises in a commit, but for the last digit of an exponential.
    if (stored.growth.degrading > 0) {
      stored.released = std::max(stored.released - higher.energy, 0.0);
    }
    stored.energy += higher.energy;
    stored.degenerate |= higher.degenerate;
  });
  return stored;
}

DamageGrowth Assembler::growth(std::span<const double> displacement) {
  const Stopwatch watch(seconds_);
  return dispatch(points().dimension, model().potential, [&]<class P>(auto d, const P& law) {
    if constexpr (PotentialWithHistory<P>) {
      return BondKernels<decltype(d)::value>::growth(*workspace_, law, displacement);
    } else {
      return DamageGrowth{};
    }
  });
}

std::span<const double> Assembler::history() const {
  const std::vector<double>& largest = workspace_->largest_stretch;
  return std::span(largest).first(largest.empty() ? 0 : std::size_t(model().bonds.count()));
}

void Assembler::hold_damage(bool holds) {
  std::visit(
      [&]<class P>(P& law) {
        if constexpr (PotentialWithHistory<P>) law.holds_damage = holds;
      },
      workspace_->potential);
}

bool Assembler::holds_damage() const {
  return std::visit(
      []<class P>(const P& law) {
        if constexpr (PotentialWithHistory<P>) return law.holds_damage;
        return false;
      },
      workspace_->potential);
}

void Assembler::restore(std::span<const double> history) {
  std::copy(history.begin(), history.end(), workspace_->largest_stretch.begin());
  workspace_->find_integrity();
}

void Assembler::tangent(std::span<const double> displacement, Tangent& tangent, double projection) {
  const Stopwatch watch(seconds_);
  const int dimension = points().dimension;
  for (std::size_t k = 0; k < displacement.size(); ++k) {
    tangent.position[k] = points().reference[k] + displacement[k];
  }
  if (!model().has_only_bonds() && tangent.blocks != Tangent::Blocks::whole) {
    throw std::logic_error("the blocks of triangles and tetrahedra are not symmetric");
  }
  dispatch(dimension, workspace_->potential, [&](auto d, const auto& law) {
    using Kernels = BondKernels<decltype(d)::value>;
    const auto blocks_of = [&](int, Index i) {
      return &tangent.off_diagonal[std::size_t(tangent.pattern.offset[i]) * tangent.block_size()];
    };
    const auto done = [](int, Index) {};
    if (tangent.blocks == Tangent::Blocks::whole) {
      Kernels::template tangent<Tangent::Blocks::whole>(*workspace_, law, displacement, projection,
                                                        blocks_of, done, tangent.diagonal);
    } else {
      Kernels::template tangent<Tangent::Blocks::upper_halves>(
          *workspace_, law, displacement, projection, blocks_of, done, tangent.diagonal);
    }
  });
  if (model().has_only_bonds()) return;
  with_dimension(dimension, [&](auto d) {
    LocalKernels<decltype(d)::value>::tangent(*workspace_, displacement, projection, tangent);
  });
}

void Assembler::visit_tangent(std::span<const double> displacement, double projection,
                              const TangentOperator::RowVisitor& visit,
                              std::span<double> diagonal) {
  const Stopwatch watch(seconds_);
  const std::vector<Offset>& offset = model().bonds.offset;
  Offset longest = 0;
  for (std::size_t i = 1; i < offset.size(); ++i) {
    longest = std::max(longest, offset[i] - offset[i - 1]);
  }
  dispatch(points().dimension, workspace_->potential, [&](auto d, const auto& law) {
    constexpr std::size_t entries = decltype(d)::value * decltype(d)::value;
    std::vector<std::vector<double>> rows(std::size_t(threads()),
                                          std::vector<double>(std::size_t(longest) * entries));
    BondKernels<decltype(d)::value>::template tangent<Tangent::Blocks::whole>(
        *workspace_, law, displacement, projection,
        [&](int thread, Index) { return rows[std::size_t(thread)].data(); },
        [&](int thread, Index i) {
          const std::size_t bonds = std::size_t(offset[i + 1] - offset[i]);
          visit(thread, i, std::span(rows[std::size_t(thread)]).first(bonds * entries));
        },
        diagonal);
  });
}

void Assembler::product(std::span<const double> displacement, std::span<const double> v,
                        std::span<double> product, double projection) {
  const Stopwatch watch(seconds_);
  const int dimension = points().dimension;
  dispatch(dimension, workspace_->potential, [&](auto d, const auto& law) {
    BondKernels<decltype(d)::value>::product(*workspace_, law, displacement, v, projection,
                                             product);
  });
  if (model().has_only_bonds()) return;
  with_dimension(dimension, [&](auto d) {
    LocalKernels<decltype(d)::value>::product(*workspace_, displacement, v, product);
  });
}

double Assembler::point_energies(std::span<const double> displacement, std::span<double> energies) {
  const Stopwatch watch(seconds_);
  const int dimension = points().dimension;
  const double longest = dispatch(dimension, workspace_->potential, [&](auto d, const auto& law) {
    return BondKernels<decltype(d)::value>::point_energies(*workspace_, law, displacement,
                                                           energies);
  });
  if (!model().has_only_bonds()) {
    with_dimension(dimension, [&](auto d) {
      LocalKernels<decltype(d)::value>::point_energies(*workspace_, displacement, energies);
    });
  }
  return longest;
}

void Assembler::point_stretches(std::span<const double> displacement,
                                std::span<double> stretches) const {
  constexpr double none = -2.0;  // below every stretch
  std::fill(stretches.begin(), stretches.end(), none);
  const std::vector<char> broken = broken_bonds(model(), history());
  const Bonds& bonds = model().bonds;
  const auto with_points = [&](auto d) {
    constexpr int D = decltype(d)::value;
    const auto difference = [&](std::span<const double> field, Index i, Index j) {
      Vector<D, double> result;
      for (int c = 0; c < D; ++c) {
        result[c] = field[std::size_t(j) * D + c] - field[std::size_t(i) * D + c];
      }
      return result;
    };
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        if (!broken.empty() && broken[bond]) continue;
        const Index j = bonds.partner[bond];
        const double stretch = Length::at<D, double>(bonds.inverse_length(bond),
                                                     {difference(points().reference, i, j)},
                                                     {difference(displacement, i, j)})
                                   .relative_change;
        stretches[i] = std::max(stretches[i], stretch);
        stretches[j] = std::max(stretches[j], stretch);
      }
    }
  };
  dispatch(points().dimension, model().potential, [&](auto d, const auto&) { with_points(d); });
  std::replace(stretches.begin(), stretches.end(), none, 0.0);
}

}  // namespace peristat
