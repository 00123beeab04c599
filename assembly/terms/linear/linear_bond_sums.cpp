#include "assembly/terms/linear/linear_bond_sums.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"

namespace peristat {

template <int D>
struct LinearBondSums::Kernels {
  /// A bond in the reference: its direction, and its stiffness times its points' integrities.
  struct Spring {
    Vector<D, Lanes> direction;
    Lanes stiffness;
  };

  LinearBondSums& of;

  [[nodiscard, gnu::always_inline]] Spring spring(Index i, const Batch<D>& batch) const {
    const double own = of.micromodulus_ * of.integrity_[std::size_t(i)];
    const Lanes integrity(
        [&](int l) { return own * of.integrity_[std::size_t(batch.partner[l])]; });
    return {scaled<D>(batch.inverse_length, batch.vector0),
            integrity * batch.weight * batch.inverse_length};
  }

  /// Calls visit(i, batch, spring, sums) for the bonds of all rows, and write(i, total) with the
  /// sums that it has added up over them.
  template <int width, class Visit, class WriteRow>
  void sum(std::span<const double> moved, const Visit& visit, const WriteRow& write) {
    BondWorkspace& a = of.workspace_;
    a.pack<D>(a.points.reference, moved);
    const auto body = [&](int, RowRange range, double* sums) {
      for (Index i = range.first; i < range.last; ++i) {
        for_each_batch<D>(
            a.bonds, a.rows.data(), i, [&](const Batch<D>& batch) __attribute__((always_inline)) {
              visit(i, batch, spring(i, batch), sums);
            });
      }
    };
    a.threads.sum_rows<width>(body, write);
  }

  void forces(std::span<const double> moved, std::span<double> force, double sign) {
    constexpr int width = vector_width(D);
    sum<width>(
        moved,
        [](Index i, const Batch<D>& batch, const Spring& bond, double* sums)
            __attribute__((always_inline)) {
              const Vector<D, Lanes> pull =
                  scaled<D>(bond.stiffness * dot<D>(bond.direction, batch.vector1), bond.direction);
              for (int c = 0; c < D; ++c)
                sums[std::ptrdiff_t(i) * width + c] += ::peristat::sum(pull[c]);
              add_to_partners<D>(sums, batch.partner, scaled<D>(Lanes(-1.0), pull));
            },
        [&](Index i, const double* total) {
          for (int c = 0; c < D; ++c) force[std::size_t(i) * D + c] = sign * total[c];
        });
  }

  void energies(std::span<const double> moved, std::span<double> energy) {
    sum<1>(
        moved,
        [](Index i, const Batch<D>& batch, const Spring& bond, double* sums)
            __attribute__((always_inline)) {
              const Lanes along = dot<D>(bond.direction, batch.vector1);
              const Lanes quarter = 0.25 * bond.stiffness * along * along;
              sums[i] += ::peristat::sum(quarter);
              add_to_partners<1>(sums, batch.partner, Vector<1, Lanes>{quarter});
            },
        [&](Index i, const double* total) { energy[std::size_t(i)] = *total; });
  }

  void virials(std::span<const double> moved, std::span<double> virials) {
    constexpr int width = vector_width(D);
    for (int component = 0; component < D; ++component) {
      sum<width>(
          moved,
          [&](Index i, const Batch<D>& batch, const Spring& bond, double* sums)
              __attribute__((always_inline)) {
                const Lanes half = 0.5 * bond.stiffness * dot<D>(bond.direction, batch.vector1) *
                                   bond.direction[component];
                const Vector<D, Lanes> row = scaled<D>(half, batch.vector0);
                for (int c = 0; c < D; ++c)
                  sums[std::ptrdiff_t(i) * width + c] += ::peristat::sum(row[c]);
                add_to_partners<D>(sums, batch.partner, row);
              },
          [&](Index i, const double* total) {
            double* const to = &virials[(std::size_t(i) * D + std::size_t(component)) * D];
            for (int c = 0; c < D; ++c) to[c] += total[c];
          });
    }
  }

  void rows(const RowVisitor& visit, std::span<double> diagonal) {
    BondWorkspace& a = of.workspace_;
    a.pack<D>(a.points.reference, a.points.reference);
    constexpr int width = block_width(D);
    Offset longest = 0;
    for (Index i = 0; i < a.bonds.points(); ++i) {
      longest = std::max(longest, a.bonds.offset[i + 1] - a.bonds.offset[i]);
    }
    const auto body = [&](int thread, RowRange range, double* sums) {
      std::vector<double> blocks(std::size_t(longest) * D * D);
      for (Index i = range.first; i < range.last; ++i) {
        const Offset begin = a.bonds.offset[i];
        for_each_batch<D>(a.bonds, a.rows.data(), i, [&](const Batch<D>& batch) {
          const Spring bond = spring(i, batch);
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
        visit(thread, i,
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
      workspace_(points, bonds, shared),
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
