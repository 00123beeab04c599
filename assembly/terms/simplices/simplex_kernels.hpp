#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "assembly/operators/tangent.hpp"
#include "assembly/terms/interaction.hpp"
#include "assembly/terms/projection.hpp"
#include "assembly/terms/simplices/simplex_workspace.hpp"

namespace peristat {

/// The arms of four interactions that share all points but the last.
template <class Measure, int D>
class BatchArms {
 public:
  static constexpr int count = Measure::arms, last = count - 1;

  template <class Group>
  BatchArms(const LocalWorkspace<D>& workspace, const Group& group)
      : workspace_(workspace), fixed_(group.partners) {
    for (int p = 0; p < last; ++p) {
      reference_[p] = workspace.local.reference.one(group.partners[p]);
      displacement_[p] = workspace.displacement.one(group.partners[p]);
    }
  }

  /// The measure of a block's interactions.
  [[nodiscard, gnu::always_inline]] auto measure(const InteractionBlock& block) {
    reference_[last] = workspace_.local.reference.block(block.first);
    displacement_[last] = workspace_.displacement.block(block.first);
    if constexpr (Measure::template singular_at_zero<D>) {
      // An empty lane may hold anything, also a measure without gradient: it repeats a full one.
      constexpr std::uint32_t full = (1U << lane_count) - 1U;
      if (block.active != full) {
        const int repeated = block.first + std::countr_zero(block.active);
        fill_empty(block, workspace_.local.reference.one(repeated), reference_[last]);
        fill_empty(block, workspace_.displacement.one(repeated), displacement_[last]);
      }
    }
    auto result =
        Measure::template at<D, Lanes>(Lanes(block.inverse_reference), reference_, displacement_);
    workspace_.relieve(result, fixed_, block);
    return result;
  }

  /// Reference arm of the interactions of the last call of `measure`.
  [[nodiscard]] const Vector<D, Lanes>& reference(int arm) const { return reference_[arm]; }

 private:
  static void fill_empty(const InteractionBlock& block, const Vector<D, Lanes>& with,
                         Vector<D, Lanes>& arm) {
    const Lanes full(interactions_detail::lanes_of_bits[block.active].data());
    for (int c = 0; c < D; ++c) arm[c] = chosen(full < 0.5, with[c], arm[c]);
  }

  const LocalWorkspace<D>& workspace_;
  const std::array<std::int32_t, std::size_t(last)>& fixed_;
  Arms<count, D, Lanes> reference_, displacement_;
};

/// The passes over triangles and tetrahedra, for one dimension. Each adds to its result.
template <int D>
struct SimplexKernels {
  using Span = std::span<const double>;

  /// Calls visit(measure type, interactions, potential) for each kind of interaction.
  template <class Visit>
  static void for_each_kind(const SimplexTerm& term, const Visit& visit) {
    const auto with_potential = [&](auto measure, const auto& simplices) {
      std::visit([&](const auto& law) { visit(measure, simplices.interactions, law); },
                 simplices.potential);
    };
    if (term.triangles()) with_potential(Area{}, *term.triangles());
    if constexpr (D == 3) {
      if (term.tetrahedra()) with_potential(Volume{}, *term.tetrahedra());
    }
  }

  /// True if interactions are not stored, so that finding them needs the pairs of a neighbourhood.
  static bool must_find(const SimplexTerm& term) {
    bool finds = false;
    term.for_each_kind([&](const auto& kind) { finds |= !kind.interactions.is_stored(); });
    return finds;
  }

  static void move_to(const SimplexWorkspace<D>& a, LocalWorkspace<D>& w, Index i,
                      Span displacement, const Influences& influences, bool find_pairs) {
    w.local.move_to(i);
    if (find_pairs) w.local.upper.find_pairs();
    w.find_integrity(influences, a.term.bonds().offset[i], find_pairs);
    w.find_eigenstretch(influences.eigenstretch);
    assign_relative(w, displacement, w.displacement);
  }

  static void assign_relative(const LocalWorkspace<D>& w, Span field, LocalVectors<D>& relative) {
    const double* own = &field[std::size_t(w.local.upper.own()) * D];
    const std::span<const Index> partner = w.local.upper.points();
    relative.assign(w.local.upper.count(),
                    [&](int a, int c) { return field[std::size_t(partner[a]) * D + c] - own[c]; });
  }

  /// Quadrature weight of a block's interactions, times the integrity of their bonds.
  template <class Group>
  static Lanes weight_of(const LocalWorkspace<D>& w, const Group& group,
                         const InteractionBlock& block) {
    return Lanes(block.weight) * w.integrity_of(group, block);
  }

  /// Adds partners' totals to their rows, and minus their sum to the point's own.
  template <int width, int stride>
  static void add_to_rows(const LocalWorkspace<D>& w, double* sums) {
    const std::span<const Index> partner = w.local.upper.points();
    std::array<double, width> own{};
    for (int a = 0; a < w.local.upper.count(); ++a) {
      const std::array<double, width> total = w.template total_of<width>(a);
      double* row = sums + std::ptrdiff_t(partner[a]) * stride;
      for (int c = 0; c < width; ++c) {
        row[c] += total[c];
        own[c] -= total[c];
      }
    }
    double* row = sums + std::ptrdiff_t(w.local.upper.own()) * stride;
    for (int c = 0; c < width; ++c) row[c] += own[c];
  }

  static Evaluation gradient(SimplexWorkspace<D>& a, Span displacement,
                             const Influences& influences, std::span<double> result) {
    const bool energy_only = result.empty();
    const bool find_pairs = must_find(a.term);
    constexpr int stride = vector_width(D);
    const auto body = [&](int part, RowRange range, double* sums) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      Lanes smallest_measure = std::numeric_limits<double>::infinity();
      double energy = 0.0;
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, find_pairs);
        w.clear(D);
        Lanes row_energy = 0.0;
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          using Measure = decltype(kind);
          constexpr int last = Measure::arms - 1;
          interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
            BatchArms<Measure, D> arms(w, group);
            Arms<last, D, Lanes> fixed{};
            for (const InteractionBlock& block : group.blocks) {
              const auto measure = arms.measure(block);
              const auto psi = interaction_energy(weight_of(w, group, block), potential, measure);
              row_energy += psi.value;
              if constexpr (Measure::template singular_at_zero<D>) {
                smallest_measure = min(smallest_measure, measure.current);
              }
              if (energy_only) continue;
              const auto force = energy_gradient(psi, measure);
              for (int p = 0; p < last; ++p) fixed[p] = plus<D>(fixed[p], force[p]);
              w.template add_to_last<D>(block.first, force[last]);
            }
            if (energy_only) return;
            for (int p = 0; p < last; ++p) {
              w.template add_to_fixed<D>(group.partners[p], fixed[p]);
            }
          });
        });
        energy += sum(row_energy);
        if (!energy_only) add_to_rows<D, stride>(w, sums);
      }
      a.threads.evaluations[part] = {energy, !(smallest(smallest_measure) > 0.0)};
    };
    a.threads.template sum_rows<stride>(body, [&](Index i, const double* total) {
      if (energy_only) return;
      for (int c = 0; c < D; ++c) result[std::size_t(i) * D + c] += total[c];
    });
    return a.threads.total_evaluation();
  }

  static void product(SimplexWorkspace<D>& a, Span displacement, const Influences& influences,
                      Span v, std::span<double> result) {
    const bool find_pairs = must_find(a.term);
    constexpr int stride = vector_width(D);
    const auto body = [&](int part, RowRange range, double* sums) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, find_pairs);
        assign_relative(w, v, w.vector);
        w.clear(D);
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          using Measure = decltype(kind);
          constexpr int last = Measure::arms - 1;
          interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
            BatchArms<Measure, D> arms(w, group);
            Arms<Measure::arms, D, Lanes> vectors;
            for (int p = 0; p < last; ++p) vectors[p] = w.vector.one(group.partners[p]);
            Arms<last, D, Lanes> fixed{};
            for (const InteractionBlock& block : group.blocks) {
              const auto measure = arms.measure(block);
              const auto psi = interaction_energy(weight_of(w, group, block), potential, measure);
              vectors[last] = w.vector.block(block.first);
              const auto force = energy_hessian_times(psi, measure, vectors);
              for (int p = 0; p < last; ++p) fixed[p] = plus<D>(fixed[p], force[p]);
              w.template add_to_last<D>(block.first, force[last]);
            }
            for (int p = 0; p < last; ++p) {
              w.template add_to_fixed<D>(group.partners[p], fixed[p]);
            }
          });
        });
        add_to_rows<D, stride>(w, sums);
      }
    };
    a.threads.template sum_rows<stride>(body, [&](Index i, const double* total) {
      for (int c = 0; c < D; ++c) result[std::size_t(i) * D + c] += total[c];
    });
  }

  /// Shares every interaction's energy equally among its points.
  static void point_energies(SimplexWorkspace<D>& a, Span displacement,
                             const Influences& influences, std::span<double> energies) {
    const bool find_pairs = must_find(a.term);
    const auto body = [&](int part, RowRange range, double* sums) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, find_pairs);
        w.clear(1);
        Lanes own = 0.0;
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          using Measure = decltype(kind);
          constexpr double share = 1.0 / (Measure::arms + 1);
          interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
            BatchArms<Measure, D> arms(w, group);
            Lanes of_group = 0.0;
            for (const InteractionBlock& block : group.blocks) {
              const auto psi =
                  interaction_energy(weight_of(w, group, block), potential, arms.measure(block));
              of_group += share * psi.value;
              w.template add_to_last<1>(block.first, {share * psi.value});
            }
            for (int partner : group.partners) w.template add_to_fixed<1>(partner, {of_group});
            own += of_group;
          });
        });
        const std::span<const Index> partner = w.local.upper.points();
        for (int k = 0; k < w.local.upper.count(); ++k) {
          sums[partner[k]] += w.template total_of<1>(k)[0];
        }
        sums[i] += sum(own);
      }
    };
    a.threads.template sum_rows<1>(body,
                                   [&](Index i, const double* total) { energies[i] += *total; });
  }

  /// Writes what each bond would set free by its triangles and tetrahedra with its integrity, their
  /// energy times the integrities of their other bonds [J].
  static void releases(SimplexWorkspace<D>& a, Span displacement, const Influences& influences,
                       std::vector<double>& of_bond) {
    const Bonds& bonds = a.term.bonds();
    of_bond.assign(std::size_t(bonds.count()), 0.0);
    a.releases_beyond.resize(a.threads.ranges.size());
    const auto body = [&](int part, RowRange range, double*) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      const Offset first_beyond = bonds.offset[range.last];
      std::vector<double>& beyond = a.releases_beyond[std::size_t(part)];
      beyond.assign(std::size_t(bonds.offset[range.touched_end] - first_beyond), 0.0);
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, true);
        w.clear_releases();
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          using Measure = decltype(kind);
          interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
            BatchArms<Measure, D> arms(w, group);
            for (const InteractionBlock& block : group.blocks) {
              const auto psi =
                  interaction_energy(Lanes(block.weight), potential, arms.measure(block));
              w.add_releases(group, block, psi.value);
            }
          });
        });
        for (int k = 0; k < w.local.upper.count(); ++k) {
          of_bond[std::size_t(bonds.offset[i] + k)] += w.own_release(k);
        }
        for (const UpperNeighbourhood::Pair& pair : w.local.upper.pairs()) {
          double& to = pair.bond < first_beyond ? of_bond[std::size_t(pair.bond)]
                                                : beyond[std::size_t(pair.bond - first_beyond)];
          to += w.pair_release(pair.a, pair.b);
        }
      }
    };
    const auto add_spilled = [&](int part, RowRange range) {
      for (int earlier = 0; earlier < part; ++earlier) {
        const RowRange other = a.threads.ranges[std::size_t(earlier)];
        const Offset last = bonds.offset[std::min(range.last, other.touched_end)];
        for (Offset bond = bonds.offset[range.first]; bond < last; ++bond) {
          of_bond[std::size_t(bond)] +=
              a.releases_beyond[std::size_t(earlier)][std::size_t(bond - bonds.offset[other.last])];
        }
      }
    };
    a.threads.template sum_rows<1>(
        body, [](Index, const double*) {}, add_spilled);
  }

  /// Adds an equal share of every interaction's virial to each of its points: a pass per component
  /// of the force, as for bonds.
  static void add_virials(SimplexWorkspace<D>& a, Span displacement, const Influences& influences,
                          std::span<double> virials) {
    for (std::size_t component = 0; component < D; ++component) {
      add_virial_rows(a, displacement, influences, component, virials);
    }
  }

  static void add_virial_rows(SimplexWorkspace<D>& a, Span displacement,
                              const Influences& influences, std::size_t component,
                              std::span<double> virials) {
    const bool find_pairs = must_find(a.term);
    constexpr int stride = vector_width(D);
    const auto body = [&](int part, RowRange range, double* sums) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, find_pairs);
        w.clear(D);
        Vector<D, Lanes> own{};
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          using Measure = decltype(kind);
          constexpr double share = 1.0 / (Measure::arms + 1);
          interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
            BatchArms<Measure, D> arms(w, group);
            Vector<D, Lanes> of_group{};
            for (const InteractionBlock& block : group.blocks) {
              const auto measure = arms.measure(block);
              const auto psi = interaction_energy(weight_of(w, group, block), potential, measure);
              const auto force = energy_gradient(psi, measure);
              Vector<D, Lanes> row{};
              for (int p = 0; p < Measure::arms; ++p) {
                row = plus<D>(row, scaled<D>(share * force[p][component], arms.reference(p)));
              }
              of_group = plus<D>(of_group, row);
              w.template add_to_last<D>(block.first, row);
            }
            for (int partner : group.partners) w.template add_to_fixed<D>(partner, of_group);
            own = plus<D>(own, of_group);
          });
        });
        const std::span<const Index> partner = w.local.upper.points();
        for (int k = 0; k < w.local.upper.count(); ++k) {
          const auto total = w.template total_of<D>(k);
          for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(partner[k]) * stride + c] += total[c];
        }
        for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(i) * stride + c] += sum(own[c]);
      }
    };
    a.threads.template sum_rows<stride>(body, [&](Index i, const double* total) {
      double* row = &virials[(std::size_t(i) * D + component) * D];
      for (int c = 0; c < D; ++c) row[c] += total[c];
    });
  }

  // ---- Tangent

  static constexpr int half_entries = D * (D + 1) / 2;

  static std::array<Lanes, half_entries> half_of(const Matrix<D, Lanes>& block) {
    std::array<Lanes, half_entries> half;
    int k = 0;
    for (int r = 0; r < D; ++r) {
      for (int c = r; c < D; ++c) half[k++] = block[r][c];
    }
    return half;
  }

  static Matrix<D, double> full_of(const std::array<double, half_entries>& half) {
    Matrix<D, double> block;
    int k = 0;
    for (int r = 0; r < D; ++r) {
      for (int c = r; c < D; ++c) block[r][c] = block[c][r] = half[k++];
    }
    return block;
  }

  /// Calls visit(P, Q) with compile-time numbers of arms P <= Q.
  template <int arms, class Visit>
  [[gnu::always_inline]] static void for_each_pair_of_arms(const Visit& visit) {
    [&]<int... K>(std::integer_sequence<int, K...>) {
      const auto at = [&](auto k) __attribute__((always_inline)) {
        constexpr int P = decltype(k)::value / arms, Q = decltype(k)::value % arms;
        if constexpr (P <= Q) {
          visit(std::integral_constant<int, P>{}, std::integral_constant<int, Q>{});
        }
      };
      (at(std::integral_constant<int, K>{}), ...);
    }
    (std::make_integer_sequence<int, arms * arms>{});
  }

  /// Relative Hessian of four interactions.
  template <int arms>
  using HessianBlocks = std::array<std::array<Matrix<D, Lanes>, arms>, arms>;

  static constexpr int none = -1;
  using ArmOfLane = std::array<int, lane_count>;

  /// Per lane the arm to the point with the lowest number in the whole body; none: the point that
  /// arms begin at.
  template <class Group>
  static ArmOfLane arms_to_lowest(const LocalWorkspace<D>& w, const PointNumbers& number,
                                  const Group& group, const InteractionBlock& block) {
    ArmOfLane result;
    result.fill(none);
    if (number.empty()) return result;
    const std::span<const Index> partner = w.local.upper.points();
    const auto number_of = [&](int local) {
      return number[std::size_t(partner[std::size_t(local)])];
    };
    GlobalIndex least = number[std::size_t(w.local.upper.own())];
    int arm = none;
    for (int p = 0; p < int(group.partners.size()); ++p) {
      const GlobalIndex of_partner = number_of(group.partners[std::size_t(p)]);
      if (of_partner < least) arm = p;
      least = std::min(least, of_partner);
    }
    for (int l = 0; l < lane_count; ++l) {
      if ((block.active >> l & 1U) == 0) continue;
      const bool is_last = number_of(block.first + l) < least;
      result[std::size_t(l)] = is_last ? int(group.partners.size()) : arm;
    }
    return result;
  }

  /// Moves the origin of a relative Hessian's arms to the end of one of them, which then ends at
  /// the old origin; a second call restores the Hessian.
  template <int arms>
  static void begin_at(int arm, double* matrix) {
    constexpr int size = arms * D;
    for (const int row : {size, 1}) {
      const int column = size + 1 - row;
      for (int r = 0; r < size; ++r) {
        for (int c = 0; c < D; ++c) {
          double sum = 0.0;
          for (int p = 0; p < arms; ++p) sum += matrix[r * row + (p * D + c) * column];
          matrix[r * row + (arm * D + c) * column] = -sum;
        }
      }
    }
  }

  /// Moves the Hessian of each active lane by a share towards its positive semidefinite part; only
  /// blocks P <= Q are read and written. The result depends on the origin of the arms: this is the
  /// lowest point, whatever the number of ranks.
  template <int arms>
  static void project(HessianBlocks<arms>& blocks, std::uint32_t active, double share,
                      const ArmOfLane& lowest) {
    constexpr int size = arms * D;
    for (int l = 0; l < lane_count; ++l) {
      if ((active >> l & 1U) == 0) continue;
      std::array<double, size * size> matrix;
      for (int p = 0; p < arms; ++p) {
        for (int q = p; q < arms; ++q) {
          for (int r = 0; r < D; ++r) {
            for (int c = 0; c < D; ++c) {
              const double entry = blocks[p][q][r][c][l];
              matrix[(p * D + r) * size + q * D + c] = entry;
              matrix[(q * D + c) * size + p * D + r] = entry;
            }
          }
        }
      }
      const int arm = lowest[std::size_t(l)];
      if (arm != none) begin_at<arms>(arm, matrix.data());
      project_to_semidefinite(matrix.data(), size, share);
      if (arm != none) begin_at<arms>(arm, matrix.data());
      for (int p = 0; p < arms; ++p) {
        for (int q = p; q < arms; ++q) {
          for (int r = 0; r < D; ++r) {
            for (int c = 0; c < D; ++c) {
              blocks[p][q][r][c].set(l, matrix[(p * D + r) * size + q * D + c]);
            }
          }
        }
      }
    }
  }

  /// Adds up the relative Hessian of a point's interactions of one kind.
  template <class Measure, class P>
  static void add_hessian(LocalWorkspace<D>& w, const Interactions<Measure>& interactions,
                          const P& potential, double projection, const PointNumbers& number) {
    constexpr int arms_count = Measure::arms, last = arms_count - 1;
    interactions.template for_each_group<D>(w.local, w.scratch, [&](const auto& group) {
      BatchArms<Measure, D> arms(w, group);
      std::array<std::array<Lanes, half_entries>, last> on_diagonal{};
      Matrix<D, Lanes> of_fixed_pair{};
      for (const InteractionBlock& block : group.blocks) {
        const auto add = [&](auto p, auto q, const Matrix<D, Lanes>& part)
            __attribute__((always_inline)) {
          if constexpr (p == last && q == last) {
            w.template add_to_last<half_entries>(block.first, half_of(part));
          } else if constexpr (p == q) {
            const auto half = half_of(part);
            for (int c = 0; c < half_entries; ++c) on_diagonal[p][c] += half[c];
          } else if constexpr (q == last) {
            w.add_to_hessian(group.partners[p], block.first, part);
          } else {
            for (int r = 0; r < D; ++r) of_fixed_pair[r] = plus<D>(of_fixed_pair[r], part[r]);
          }
        };
        const auto measure = arms.measure(block);
        const auto psi = interaction_energy(weight_of(w, group, block), potential, measure);
        if (projection == 0.0) {
          for_each_pair_of_arms<arms_count>([&](auto p, auto q) __attribute__((always_inline)) {
            add(p, q, energy_hessian<p, q>(psi, measure));
          });
        } else {
          HessianBlocks<arms_count> blocks;
          for_each_pair_of_arms<arms_count>(
              [&](auto p, auto q) { blocks[p][q] = energy_hessian<p, q>(psi, measure); });
          project<arms_count>(blocks, block.active, projection,
                              arms_to_lowest(w, number, group, block));
          for_each_pair_of_arms<arms_count>([&](auto p, auto q) { add(p, q, blocks[p][q]); });
        }
      }
      for (int p = 0; p < last; ++p) {
        w.template add_to_fixed<half_entries>(group.partners[p], on_diagonal[p]);
      }
      if constexpr (last == 2) w.add_to_pair(group.partners[0], group.partners[1], of_fixed_pair);
    });
  }

  static void tangent(SimplexWorkspace<D>& a, Span displacement, const Influences& influences,
                      double projection, Tangent& result) {
    const Bonds& bonds = a.term.bonds();
    constexpr int stride = block_width(D), entries = D * D;
    const auto body = [&](int part, RowRange range, double* sums) {
      LocalWorkspace<D>& w = *a.local[std::size_t(part)];
      std::vector<double>& beyond = a.blocks[part];
      const Offset first_beyond = a.pattern.offset[range.last];
      std::fill(beyond.begin(), beyond.end(), 0.0);
      const auto block_of = [&](Offset bond) {
        const Offset place = a.place(bond);
        return place < first_beyond ? &result.off_diagonal[std::size_t(place) * entries]
                                    : &beyond[std::size_t(place - first_beyond) * entries];
      };
      for (Index i = range.first; i < range.last; ++i) {
        move_to(a, w, i, displacement, influences, true);
        w.clear(half_entries);
        w.clear_hessian();
        for_each_kind(a.term, [&](auto kind, const auto& interactions, const auto& potential) {
          add_hessian<decltype(kind)>(w, interactions, potential, projection, a.term.numbers());
        });

        // With H_ab the relative Hessian: K_ab += H_ab, K_ib -= sum_a H_ab, K_ii += sum_ab H_ab.
        const std::span<const Index> partner = w.local.upper.points();
        const auto of_own_bond = [&](int k) {
          return &result.off_diagonal[std::size_t(a.place(bonds.offset[i] + k)) * entries];
        };
        Matrix<D, double> own{};
        for (int k = 0; k < w.local.upper.count(); ++k) {
          const auto half = w.template total_of<half_entries>(k);
          double* row = sums + std::ptrdiff_t(partner[k]) * stride;
          for (int c = 0; c < half_entries; ++c) row[c] += half[c];
          const Matrix<D, double> block = full_of(half);
          double* const to = of_own_bond(k);
          for (int r = 0; r < D; ++r) {
            for (int c = 0; c < D; ++c) {
              to[r * D + c] -= block[r][c];
              own[r][c] += block[r][c];
            }
          }
        }
        for (const UpperNeighbourhood::Pair& pair : w.local.upper.pairs()) {
          const Matrix<D, double> block = w.pair(pair.a, pair.b);
          double* to = block_of(pair.bond);
          double *const to_a = of_own_bond(pair.a), *const to_b = of_own_bond(pair.b);
          for (int r = 0; r < D; ++r) {
            for (int c = 0; c < D; ++c) {
              to[r * D + c] += block[r][c];
              to_b[r * D + c] -= block[r][c];
              to_a[c * D + r] -= block[r][c];
              own[r][c] += block[r][c];
              own[c][r] += block[r][c];
            }
          }
        }
        double* row = sums + std::ptrdiff_t(i) * stride;
        int k = 0;
        for (int r = 0; r < D; ++r) {
          for (int c = r; c < D; ++c) row[k++] += own[r][c];
        }
      }
    };
    const auto add_spilled_blocks = [&](int part, RowRange range) {
      for (int earlier = 0; earlier < part; ++earlier) {
        const RowRange other = a.threads.ranges[earlier];
        const Index last = std::min(range.last, other.touched_end);
        if (last <= range.first) continue;
        const std::size_t from = std::size_t(a.pattern.offset[range.first]) * entries;
        const std::size_t count = std::size_t(a.pattern.offset[last]) * entries - from;
        const double* spilled =
            a.blocks[earlier].data() + from - std::size_t(a.pattern.offset[other.last]) * entries;
        for (std::size_t k = 0; k < count; ++k) result.off_diagonal[from + k] += spilled[k];
      }
    };
    a.threads.template sum_rows<stride>(
        body,
        [&](Index i, const double* total) {
          double* block = &result.diagonal[std::size_t(i) * entries];
          int k = 0;
          for (int r = 0; r < D; ++r) {
            for (int c = r; c < D; ++c, ++k) {
              block[r * D + c] += total[k];
              if (c > r) block[c * D + r] += total[k];
            }
          }
        },
        add_spilled_blocks);
  }
};

}  // namespace peristat
