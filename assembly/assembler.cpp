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

/// Numbers in the history of the bonds: kernels read a batch of lanes.
std::size_t padded_bonds(const Model& model) {
  return std::size_t(model.bonds.count()) + lane_count;
}

/// Calls body(dimension, law, history of the bonds) with the dimension as a compile-time constant
/// and the potential as its own type.
template <class Body>
auto dispatch(const Workspace& workspace, const StateView& at, const Body& body) {
  const auto with_law = [&](const auto& law, const double* largest_stretch) {
    switch (workspace.points.dimension) {
      case 1:
        return body(std::integral_constant<int, 1>{}, law, largest_stretch);
      case 2:
        return body(std::integral_constant<int, 2>{}, law, largest_stretch);
      default:
        return body(std::integral_constant<int, 3>{}, law, largest_stretch);
    }
  };
  return std::visit(
      [&]<class P>(const P& potential) {
        if constexpr (PotentialWithHistory<P>) {
          const std::span<const double> history = at.history.of(bond_history);
          if (history.size() != padded_bonds(workspace.model)) {
            throw std::logic_error("bonds that can be damaged are evaluated after their history");
          }
          P law = potential;
          law.holds_damage = at.damage == Damage::held;
          return with_law(law, history.data());
        } else {
          return with_law(potential, nullptr);
        }
      },
      workspace.model.potential);
}

/// Calls body with the dimension as a compile-time constant, for models with more than bonds.
template <class Body>
void with_dimension(int dimension, const Body& body) {
  if (dimension == 2) body(std::integral_constant<int, 2>{});
  if (dimension == 3) body(std::integral_constant<int, 3>{});
}

Integrity integrity_after(const Model& model, const History& history) {
  const std::span<const double> integrity = history.of(integrity_history);
  if (integrity.empty()) return {};
  const auto bonds = std::size_t(model.bonds.count());
  return {integrity.first(bonds), integrity.subspan(bonds)};
}

/// Takes the integrity of bonds and points from the histories of the bonds.
void find_integrity(const Model& model, History& history) {
  const Bonds& bonds = model.bonds;
  const auto count = std::size_t(bonds.count());
  std::vector<double> integrity(count + std::size_t(bonds.points()), 1.0);
  double* const of_point = integrity.data() + count;
  const std::span<const double> largest_stretch = history.of(bond_history);
  std::visit(
      [&]<class P>(const P& law) {
        if constexpr (PotentialWithHistory<P>) {
          for (Index i = 0; i < bonds.points(); ++i) {
            for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
              integrity[bond] = law.integrity_after(largest_stretch[bond]);
              for (const Index point : {i, bonds.partner[bond]}) {
                of_point[point] = std::min(of_point[point], integrity[bond]);
              }
            }
          }
        }
      },
      model.potential);
  history.replace(integrity_history, std::move(integrity));
}

/// Energy of triangles and tetrahedra, and their forces, added to the gradient.
Stored higher_gradient(Workspace& workspace, const StateView& at, std::span<double> gradient) {
  Stored stored;
  with_dimension(workspace.points.dimension, [&](auto d) {
    stored = LocalKernels<decltype(d)::value>::gradient(
        workspace, at.displacement, integrity_after(workspace.model, at.history), gradient);
  });
  return stored;
}

void add(const Stored& higher, Stored& stored) {
  stored.energy += higher.energy;
  stored.degenerate |= higher.degenerate;
}

template <class Term>
bool is_negative(const std::optional<Term>& term) {
  return term && std::visit([](const auto& law) { return law.modulus < 0.0; }, term->potential);
}

}  // namespace

Assembler::Assembler(const Points& points, const Model& model, int threads)
    : workspace_(std::make_unique<Workspace>(points, model, threads)) {
  if (model.has_history() && (is_negative(model.triangles) || is_negative(model.tetrahedra))) {
    throw std::logic_error("what is lost with a bond must not hold negative energy");
  }
}
Assembler::~Assembler() = default;

int Assembler::threads() const { return workspace_->threads(); }
const Points& Assembler::points() const { return workspace_->points; }
const Model& Assembler::model() const { return workspace_->model; }

History Assembler::initial_history() const {
  History history;
  std::visit(
      [&]<class P>(const P&) {
        if constexpr (PotentialWithHistory<P>) {
          std::vector<double> largest_stretch(padded_bonds(model()), 0.0);
          const std::vector<char>& never_fails = model().never_fails;
          for (std::size_t bond = 0; bond < never_fails.size(); ++bond) {
            if (never_fails[bond]) largest_stretch[bond] = P::never_fails;
          }
          history.replace(bond_history, std::move(largest_stretch));
        }
      },
      model().potential);
  return history;
}

History Assembler::history_of(std::span<const double> bond_stretches) const {
  History history;
  if (!model().has_history()) return history;
  std::vector<double> largest_stretch(padded_bonds(model()), 0.0);
  if (bond_stretches.size() + lane_count != largest_stretch.size()) {
    throw std::logic_error("a history has a stretch for every bond");
  }
  std::copy(bond_stretches.begin(), bond_stretches.end(), largest_stretch.begin());
  history.replace(bond_history, std::move(largest_stretch));
  if (!model().has_only_bonds()) find_integrity(model(), history);
  return history;
}

Stored Assembler::energy(const StateView& at) { return gradient(at, {}); }

Stored Assembler::gradient(const StateView& at, std::span<double> gradient) {
  const Stopwatch watch(seconds_);
  Stored stored =
      dispatch(*workspace_, at, [&](auto d, const auto& law, const double* largest_stretch) {
        return BondKernels<decltype(d)::value>::template gradient<false>(
            *workspace_, law, at.displacement, largest_stretch, gradient);
      });
  if (!model().has_only_bonds()) add(higher_gradient(*workspace_, at, gradient), stored);
  return stored;
}

Stored Assembler::commit(std::span<const double> displacement, History& history,
                         std::span<double> gradient) {
  const StateView at(displacement, history);
  if (!model().has_history()) return this->gradient(at, gradient);
  const Stopwatch watch(seconds_);
  double* const largest_stretch = history.change(bond_history).data();
  Stored stored = dispatch(*workspace_, at, [&]<class P>(auto d, const P& law, const double*) {
    if constexpr (PotentialWithHistory<P>) {
      return BondKernels<decltype(d)::value>::template gradient<true>(
          *workspace_, law, displacement, largest_stretch, gradient);
    } else {
      return Stored{};
    }
  });
  if (model().has_only_bonds()) return stored;
  double before = 0.0;
  if (stored.growth.degrading > 0) {
    before = higher_gradient(*workspace_, at, {}).energy;
    find_integrity(model(), history);
  }
  const Stored higher = higher_gradient(*workspace_, at, gradient);
  // No integrity rises in a commit, but for the last digit of an exponential.
  if (stored.growth.degrading > 0) stored.released = std::max(before - higher.energy, 0.0);
  add(higher, stored);
  return stored;
}

DamageGrowth Assembler::growth(const StateView& at) {
  if (!model().has_history()) return {};
  const Stopwatch watch(seconds_);
  return dispatch(*workspace_, at,
                  [&]<class P>(auto d, const P& law, const double* largest_stretch) {
                    if constexpr (PotentialWithHistory<P>) {
                      return BondKernels<decltype(d)::value>::growth(
                          *workspace_, law, at.displacement, largest_stretch);
                    } else {
                      return DamageGrowth{};
                    }
                  });
}

void Assembler::tangent(const StateView& at, Tangent& tangent, double projection) {
  const Stopwatch watch(seconds_);
  for (std::size_t k = 0; k < at.displacement.size(); ++k) {
    tangent.position[k] = points().reference[k] + at.displacement[k];
  }
  if (!model().has_only_bonds() && tangent.blocks != Tangent::Blocks::whole) {
    throw std::logic_error("the blocks of triangles and tetrahedra are not symmetric");
  }
  dispatch(*workspace_, at, [&](auto d, const auto& law, const double* largest_stretch) {
    using Kernels = BondKernels<decltype(d)::value>;
    const auto blocks_of = [&](int, Index i) {
      return &tangent.off_diagonal[std::size_t(tangent.pattern.offset[i]) * tangent.block_size()];
    };
    const auto done = [](int, Index) {};
    if (tangent.blocks == Tangent::Blocks::whole) {
      Kernels::template tangent<Tangent::Blocks::whole>(*workspace_, law, at.displacement,
                                                        largest_stretch, projection, blocks_of,
                                                        done, tangent.diagonal);
    } else {
      Kernels::template tangent<Tangent::Blocks::upper_halves>(*workspace_, law, at.displacement,
                                                               largest_stretch, projection,
                                                               blocks_of, done, tangent.diagonal);
    }
  });
  if (model().has_only_bonds()) return;
  with_dimension(points().dimension, [&](auto d) {
    LocalKernels<decltype(d)::value>::tangent(
        *workspace_, at.displacement, integrity_after(model(), at.history), projection, tangent);
  });
}

void Assembler::visit_tangent(const StateView& at, double projection,
                              const TangentOperator::RowVisitor& visit,
                              std::span<double> diagonal) {
  const Stopwatch watch(seconds_);
  const std::vector<Offset>& offset = model().bonds.offset;
  Offset longest = 0;
  for (std::size_t i = 1; i < offset.size(); ++i) {
    longest = std::max(longest, offset[i] - offset[i - 1]);
  }
  dispatch(*workspace_, at, [&](auto d, const auto& law, const double* largest_stretch) {
    constexpr std::size_t entries = decltype(d)::value * decltype(d)::value;
    std::vector<std::vector<double>> rows(std::size_t(threads()),
                                          std::vector<double>(std::size_t(longest) * entries));
    BondKernels<decltype(d)::value>::template tangent<Tangent::Blocks::whole>(
        *workspace_, law, at.displacement, largest_stretch, projection,
        [&](int thread, Index) { return rows[std::size_t(thread)].data(); },
        [&](int thread, Index i) {
          const std::size_t bonds = std::size_t(offset[i + 1] - offset[i]);
          visit(thread, i, std::span(rows[std::size_t(thread)]).first(bonds * entries));
        },
        diagonal);
  });
}

void Assembler::product(const StateView& at, std::span<const double> v, std::span<double> product,
                        double projection) {
  const Stopwatch watch(seconds_);
  dispatch(*workspace_, at, [&](auto d, const auto& law, const double* largest_stretch) {
    BondKernels<decltype(d)::value>::product(*workspace_, law, at.displacement, largest_stretch, v,
                                             projection, product);
  });
  if (model().has_only_bonds()) return;
  with_dimension(points().dimension, [&](auto d) {
    LocalKernels<decltype(d)::value>::product(*workspace_, at.displacement,
                                              integrity_after(model(), at.history), v, product);
  });
}

double Assembler::point_energies(const StateView& at, std::span<double> energies) {
  const Stopwatch watch(seconds_);
  const double longest =
      dispatch(*workspace_, at, [&](auto d, const auto& law, const double* largest_stretch) {
        return BondKernels<decltype(d)::value>::point_energies(*workspace_, law, at.displacement,
                                                               largest_stretch, energies);
      });
  if (!model().has_only_bonds()) {
    with_dimension(points().dimension, [&](auto d) {
      LocalKernels<decltype(d)::value>::point_energies(
          *workspace_, at.displacement, integrity_after(model(), at.history), energies);
    });
  }
  return longest;
}

void Assembler::point_stretches(const StateView& at, std::span<double> stretches) const {
  constexpr double none = -2.0;  // below every stretch
  std::fill(stretches.begin(), stretches.end(), none);
  const std::vector<char> broken = broken_bonds(model(), at.history);
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
                                                     {difference(at.displacement, i, j)})
                                   .relative_change;
        stretches[i] = std::max(stretches[i], stretch);
        stretches[j] = std::max(stretches[j], stretch);
      }
    }
  };
  switch (points().dimension) {
    case 1:
      with_points(std::integral_constant<int, 1>{});
      break;
    case 2:
      with_points(std::integral_constant<int, 2>{});
      break;
    default:
      with_points(std::integral_constant<int, 3>{});
  }
  std::replace(stretches.begin(), stretches.end(), none, 0.0);
}

}  // namespace peristat
