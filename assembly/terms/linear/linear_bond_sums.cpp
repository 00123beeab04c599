#include "assembly/terms/linear/linear_bond_sums.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/bond_sums.hpp"

namespace peristat {

namespace {

/// Values of points that bonds have at their ends, multiplied; 1 in lanes past them.
template <int D>
[[gnu::always_inline]] inline Lanes product_of_ends(const std::vector<double>& of_point,
                                                    const Batch<D>& batch) {
  const double own = of_point[std::size_t(batch.point)];
  return Lanes([&](int l) { return own * of_point[std::size_t(batch.partner[l])]; });
}
template <int D>
[[gnu::always_inline]] inline Lanes product_of_ends(const std::vector<double>& of_point,
                                                    const RunBonds<D>& batch) {
  const double* const own = of_point.data() + (batch.run.first + batch.first);
  if (batch.count == lane_count) return Lanes(own) * Lanes(own + batch.run.ahead);
  return Lanes([&](int l) { return l < batch.count ? own[l] * own[l + batch.run.ahead] : 1.0; });
}

}  // namespace

template <int D>
struct LinearBondSums::Kernels {
  /// A bond in the reference: its direction, and its stiffness times its points' integrities.
  struct Spring {
    Vector<D, Lanes> direction;
    Lanes stiffness;
  };

  LinearBondSums& of;

  [[nodiscard, gnu::always_inline]] Spring spring(const auto& batch) const {
    const Lanes stiffness = of.micromodulus_ * batch.weight * batch.inverse_length;
    return {scaled<D>(batch.inverse_length, batch.vector0),
            stiffness * product_of_ends(of.integrity_, batch)};
  }

  /// Sums part_of(batch, spring) of bonds, see sum_bonds.
  template <int width, int sign, class PartOf, class Done>
  void sum_parts(std::span<const double> moved, const PartOf& part_of, const Done& done) {
    of.workspace_.template take<D>({of.workspace_.points.reference, moved});
    sum_bonds<D, width, sign>(
        of.workspace_, of.workspace_.bonds.kind,
        [&](const auto& batch, const RunDamage*, int)
            __attribute__((always_inline)) { return part_of(batch, spring(batch)); },
        done);
  }

  void forces(std::span<const double> moved, std::span<double> force, double sign) {
    sum_parts<D, -1>(
        moved, [](const auto& batch, const Spring& bond) __attribute__((always_inline)) {
          return scaled<D>(bond.stiffness * dot<D>(bond.direction, batch.vector1), bond.direction);
        },
        [&](Index i, const double* total) {
          for (int c = 0; c < D; ++c) force[std::size_t(i) * D + c] = -sign * total[c];
        });
  }

  void energies(std::span<const double> moved, std::span<double> energy) {
    sum_parts<1, 1>(
        moved, [](const auto& batch, const Spring& bond) __attribute__((always_inline)) {
          const Lanes along = dot<D>(bond.direction, batch.vector1);
          return Vector<1, Lanes>{0.25 * bond.stiffness * along * along};
        },
        [&](Index i, const double* total) { energy[std::size_t(i)] = *total; });
  }

  void virials(std::span<const double> moved, std::span<double> virials) {
    for (int component = 0; component < D; ++component) {
      sum_parts<D, 1>(
          moved,
          [&](const auto& batch, const Spring& bond) __attribute__((always_inline)) {
            const Lanes half = 0.5 * bond.stiffness * dot<D>(bond.direction, batch.vector1) *
                               bond.direction[component];
            return scaled<D>(half, batch.vector0);
          },
          [&](Index i, const double* total) {
            double* const to = &virials[(std::size_t(i) * D + std::size_t(component)) * D];
            for (int c = 0; c < D; ++c) to[c] += total[c];
          });
    }
  }

  void rows(const RowVisitor& visit, std::span<double> diagonal) {
    BondWorkspace& a = of.workspace_;
    const auto packed = a.pack<D>({a.points.reference, a.points.reference});
    constexpr int width = block_width(D);
    Offset longest = 0;
    for (Index i = 0; i < a.bonds.points(); ++i) {
      longest = std::max(longest, a.bonds.offset[i + 1] - a.bonds.offset[i]);
    }
    const auto body = [&](int part, RowRange range, double* sums) {
      std::vector<double> blocks(std::size_t(longest) * D * D);
      for (Index i = range.first; i < range.last; ++i) {
        const Offset begin = a.bonds.offset[i];
        for_each_batch<D>(a.bonds, a.rows<D>(), i, [&](const Batch<D>& batch) {
          const Spring bond = spring(batch);
          Matrix<D, Lanes> block;
          for (int r = 0; r < D; ++r) {
            for (int c = 0; c < D; ++c)
              block[r][c] = bond.stiffness * bond.direction[r] * bond.direction[c];
          }
          store_blocks<D>(&blocks[std::size_t(batch.first - begin) * D * D], batch.count, block);
          const auto half = upper_half<D>(block);
          for (int c = 0; c < width; ++c)
            sums[std::ptrdiff_t(i) * width + c] += ::peristat::sum(half[c]);
          add_to_partners<D>(sums, batch.partner, half);
        });
        visit(part, i,
              std::span<const double>(blocks).first(std::size_t(a.bonds.offset[i + 1] - begin) * D *
                                                    D));
      }
    };
    a.threads.sum_rows<width>(body, [&](Index i, const double* total) {
      if (diagonal.empty()) return;
      double* const block = &diagonal[std::size_t(i) * D * D];
      int k = 0;
      for (int r = 0; r < D; ++r) {
        for (int c = r; c < D; ++c) block[r * D + c] = block[c * D + r] = total[k++];
      }
    });
  }
};

template <class Body>
void LinearBondSums::in_dimension(const Body& body) {
  switch (workspace_.points.dimension) {
    case 1:
      return body(Kernels<1>{*this});
    case 2:
      return body(Kernels<2>{*this});
    default:
      return body(Kernels<3>{*this});
  }
}

LinearBondSums::LinearBondSums(const Points& points, const Bonds& bonds, double micromodulus,
                               Workspace& shared)
    : micromodulus_(micromodulus),
      workspace_(points, bonds, shared, &bonds.kind),
      integrity_(std::size_t(points.count()), 1.0) {}

void LinearBondSums::set_integrity(std::span<const double> integrity) {
  integrity_.assign(integrity.begin(), integrity.end());
}

void LinearBondSums::find_forces(std::span<const double> displacement, std::span<double> force) {
  in_dimension([&](auto kernels) { kernels.forces(displacement, force, 1.0); });
}

void LinearBondSums::find_forces_and_energies(std::span<const double> displacement,
                                              std::span<double> force, std::span<double> energy) {
  find_forces(displacement, force);
  find_energies(displacement, energy);
}

void LinearBondSums::find_energies(std::span<const double> displacement, std::span<double> energy) {
  in_dimension([&](auto kernels) { kernels.energies(displacement, energy); });
}

void LinearBondSums::multiply(std::span<const double> /*displacement*/, std::span<const double> v,
                              std::span<double> product) {
  in_dimension([&](auto kernels) { kernels.forces(v, product, -1.0); });
}

void LinearBondSums::outline_tangent(std::span<const double> /*displacement*/,
                                     std::span<double> diagonal, std::span<double> row_sums) {
  const auto d = std::size_t(workspace_.points.dimension);
  std::vector<double> blocks(diagonal.size());
  visit_tangent([](int, Index, std::span<const double>) {}, blocks);
  // See LinearBonds::outline_tangent.
  for (std::size_t i = 0; i < integrity_.size(); ++i) {
    const double* const block = &blocks[i * d * d];
    double trace = 0.0;
    for (std::size_t a = 0; a < d; ++a) trace += block[a * (d + 1)];
    for (std::size_t a = 0; a < d; ++a) {
      double& row = row_sums[i * d + a];
      row += 0.5 * (trace + double(d) * block[a * (d + 1)]);
      for (std::size_t b = 0; b < d; ++b) {
        diagonal[(i * d + a) * d + b] += block[a * d + b];
        row += std::abs(block[a * d + b]);
      }
    }
  }
}

void LinearBondSums::add_virials(std::span<const double> displacement, std::span<double> virials) {
  in_dimension([&](auto kernels) { kernels.virials(displacement, virials); });
}

void LinearBondSums::visit_tangent(const RowVisitor& visit, std::span<double> diagonal) {
  in_dimension([&](auto kernels) { kernels.rows(visit, diagonal); });
}

}  // namespace peristat
