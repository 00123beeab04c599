#include "solvers/linear/rigid_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

#include <Eigen/CholmodSupport>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <fmt/format.h>
#include <omp.h>

#include "solvers/linear/block_jacobi.hpp"

namespace peristat {
namespace {

using Long = SuiteSparse_long;
using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Long>;

/// Width of the boxes that the body is divided into, in horizons: the smaller, the fewer iterations
/// and the larger the coarse matrix. And the least, in bonds of the shortest kind.
constexpr double box_in_horizons = 4.0 / 3.0, box_in_spacings = 2.5;

/// Pieces that the boxes of a body may be: beyond, boxes grow, for the sake of the coarse factor.
constexpr std::array<double, 3> most_boxes{1e6, 2e5, 2e4};

/// A motion that keeps less than this of its length beside the others is one of theirs.
constexpr double dependent = 1e-6;

/// A block below this share of its points' diagonal is a broken bond.
constexpr double broken = 1e-9;

/// Keeps motions without stiffness from a zero pivot; far below what changes a correction.
constexpr double relative_shift = 1e-12;

constexpr int motions_of(int dimension) { return dimension * (dimension + 1) / 2; }

/// Component c of the motion m about a centre: translations, then rotations.
template <int D>
double motion(int m, int c, const std::array<double, 3>& arm) {
  if (m < D) return c == m ? 1.0 : 0.0;
  // Rotation in the plane of the axes a and b.
  const int a = D == 2 ? 0 : m - D, b = D == 2 ? 1 : (a + 1) % 3;
  if (c == a) return -arm[b];
  return c == b ? arm[a] : 0.0;
}

Index root(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

struct RigidPieces::Levels {
  const FreeDofs* free = nullptr;
  BlockJacobi fine{BlockJacobi::Blocks::points};
  Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower> coarse;
  std::vector<Index> box;     // per point
  std::vector<Index> piece;   // per point
  std::vector<double> basis;  // equations x motions
  std::vector<Index> first;   // coarse equation of each piece, and their number
  std::vector<Index> member;  // points, grouped by piece
  std::vector<Index> offset;  // of each piece in member
  Eigen::VectorXd coarse_residual, coarse_correction;
  int dimension = 0, threads = 1;

  /// Boxes in the configuration of the first tangent.
  void find_boxes(const TangentOperator& tangent) {
    const int d = dimension;
    const Index points = tangent.pattern.points();
    double longest = 0.0, shortest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < points; ++i) {
      for (Offset bond = tangent.pattern.offset[i]; bond < tangent.pattern.offset[i + 1]; ++bond) {
        double squared = 0.0;
        for (int c = 0; c < d; ++c) {
          const double x = tangent.position[std::size_t(tangent.pattern.partner[bond]) * d + c] -
                           tangent.position[std::size_t(i) * d + c];
          squared += x * x;
        }
        longest = std::max(longest, squared);
        shortest = std::min(shortest, squared);
      }
    }
    longest = std::sqrt(longest);
    shortest = std::sqrt(std::min(shortest, longest * longest));
    std::array<double, 3> least, most, count{1.0, 1.0, 1.0};
    least.fill(std::numeric_limits<double>::infinity());
    most.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < tangent.position.size(); ++k) {
      least[k % d] = std::min(least[k % d], tangent.position[k]);
      most[k % d] = std::max(most[k % d], tangent.position[k]);
    }
    double width = std::max({box_in_horizons * longest, box_in_spacings * shortest,
                             std::numeric_limits<double>::min()});
    for (double boxes = std::numeric_limits<double>::infinity(); boxes > most_boxes[d - 1];
         width *= 1.1) {
      boxes = 1.0;
      for (int c = 0; c < d; ++c) {
        count[c] = std::max(1.0, std::round((most[c] - least[c] + shortest) / width));
        boxes *= count[c];
      }
    }
    box.resize(points);
    for (Index i = 0; i < points; ++i) {
      double number = 0.0;
      for (int c = 0; c < d; ++c) {
        const double extent = most[c] - least[c];
        const double share =
            extent > 0.0 ? (tangent.position[std::size_t(i) * d + c] - least[c]) / extent : 0.0;
        number = number * count[c] + std::min(std::floor(share * count[c]), count[c] - 1.0);
      }
      box[i] = static_cast<Index>(number);
    }
  }

  /// Parts of the boxes that unbroken bonds join.
  void find_pieces(const TangentOperator& tangent) {
    const Pattern& pattern = tangent.pattern;
    const int d = dimension, entries = d * d;
    const Index points = pattern.points();
    const auto trace = [&](Index i) {
      double sum = 0.0;
      for (int c = 0; c < d; ++c) sum += tangent.diagonal[std::size_t(i) * entries + c * (d + 1)];
      return sum;
    };
    // Bonds that join, found side by side; the union is serial.
    std::vector<char> joins(std::size_t(pattern.blocks()), 0);
    tangent.for_each_row([&](int, Index i, std::span<const double> blocks) {
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const Index j = pattern.partner[bond];
        if (box[i] != box[j]) continue;
        const double* block = &blocks[std::size_t(bond - pattern.offset[i]) * entries];
        double largest = 0.0;
        for (int k = 0; k < entries; ++k) largest = std::max(largest, std::abs(block[k]));
        joins[bond] = largest > broken * std::min(trace(i), trace(j));
      }
    });
    std::vector<Index> parent(points);
    std::iota(parent.begin(), parent.end(), 0);
    for (Index i = 0; i < points; ++i) {
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        if (joins[bond]) parent[root(parent, i)] = root(parent, pattern.partner[bond]);
      }
    }
    std::vector<Index> number(points, -1);
    piece.resize(points);
    Index pieces = 0;
    for (Index i = 0; i < points; ++i) {
      Index& of_root = number[root(parent, i)];
      if (of_root < 0) of_root = pieces++;
      piece[i] = of_root;
    }
    offset.assign(std::size_t(pieces) + 1, 0);
    for (Index i = 0; i < points; ++i) ++offset[piece[i] + 1];
    std::partial_sum(offset.begin(), offset.end(), offset.begin());
    member.resize(points);
    std::vector<Index> place(offset.begin(), offset.end() - 1);
    for (Index i = 0; i < points; ++i) member[place[piece[i]]++] = i;
  }

  /// Orthonormal motions of each piece on its equations, by Gram and Schmidt's method done twice.
  template <int D>
  void find_basis(const TangentOperator& tangent) {
    constexpr int motions = motions_of(D);
    const Index pieces = static_cast<Index>(offset.size()) - 1;
    basis.assign(std::size_t(free->count()) * motions, 0.0);
    first.assign(std::size_t(pieces) + 1, 0);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      const std::span<const Index> members(&member[offset[p]],
                                           &member[offset[p]] + (offset[p + 1] - offset[p]));
      std::array<double, 3> centre{};
      for (const Index i : members) {
        for (int c = 0; c < D; ++c) centre[c] += tangent.position[std::size_t(i) * D + c];
      }
      for (double& c : centre) c /= double(members.size());
      int kept = 0;
      const auto for_each_equation = [&](const auto& visit) {
        for (const Index i : members) {
          for (int c = 0; c < D; ++c) {
            const Index e = free->equation[std::size_t(i) * D + c];
            if (e != FreeDofs::none) visit(i, c, &basis[std::size_t(e) * motions]);
          }
        }
      };
      for (int m = 0; m < motions; ++m) {
        double before = 0.0, squared = 0.0;
        for_each_equation([&](Index i, int c, double* row) {
          std::array<double, 3> arm{};
          for (int k = 0; k < D; ++k) {
            arm[k] = tangent.position[std::size_t(i) * D + k] - centre[k];
          }
          row[kept] = motion<D>(m, c, arm);
          before += row[kept] * row[kept];
        });
        for (int sweep = 0; sweep < 2; ++sweep) {
          for (int k = 0; k < kept; ++k) {
            double shared = 0.0;
            for_each_equation([&](Index, int, const double* row) { shared += row[k] * row[kept]; });
            for_each_equation([&](Index, int, double* row) { row[kept] -= shared * row[k]; });
          }
        }
        for_each_equation([&](Index, int, const double* row) { squared += row[kept] * row[kept]; });
        const bool is_new = squared > dependent * dependent * before && squared > 0.0;
        const double scale = is_new ? 1.0 / std::sqrt(squared) : 0.0;
        for_each_equation([&](Index, int, double* row) { row[kept] *= scale; });
        kept += is_new;
      }
      first[p + 1] = kept;
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
  }

  /// Blocks of E between two pieces, as one thread adds them up.
  template <int D>
  class CoarseBlocks {
   public:
    static constexpr int motions = motions_of(D);
    using Block = Eigen::Matrix<double, motions, motions>;

    Block& between(Index a, Index b) {
      const std::uint64_t key = std::uint64_t(a) << 32 | std::uint32_t(b);
      if (key != last_key_) {
        last_key_ = key;
        const auto [at, is_new] = number_.try_emplace(key, blocks_.size());
        if (is_new) blocks_.emplace_back(key, Block::Zero());
        last_ = at->second;
      }
      return blocks_[last_].second;
    }

    template <class Visit>
    void for_each(const Visit& visit) const {
      for (const auto& [key, block] : blocks_) {
        visit(static_cast<Index>(key >> 32), static_cast<Index>(key & 0xffffffffu), block);
      }
    }

   private:
    std::unordered_map<std::uint64_t, std::size_t> number_;
    std::vector<std::pair<std::uint64_t, Block>> blocks_;
    std::uint64_t last_key_ = ~std::uint64_t(0);
    std::size_t last_ = 0;
  };

  /// Rows of the basis that belong to a point, zero where it is prescribed.
  template <int D>
  Eigen::Matrix<double, motions_of(D), D> motions_at(Index i) const {
    constexpr int motions = motions_of(D);
    Eigen::Matrix<double, motions, D> result;
    for (int c = 0; c < D; ++c) {
      const Index e = free->equation[std::size_t(i) * D + c];
      if (e == FreeDofs::none) {
        result.col(c).setZero();
      } else {
        result.col(c) =
            Eigen::Map<const Eigen::Matrix<double, motions, 1>>(&basis[std::size_t(e) * motions]);
      }
    }
    return result;
  }

  /// Lower triangle of E.
  template <int D>
  Matrix coarse_matrix(const TangentOperator& tangent) const {
    constexpr int motions = motions_of(D);
    using Motions = Eigen::Matrix<double, motions, D>;
    using Entries = Eigen::Map<const Eigen::Matrix<double, D, D, Eigen::RowMajor>>;
    const Pattern& pattern = tangent.pattern;
    std::vector<CoarseBlocks<D>> parts(std::size_t(tangent.threads()));
    tangent.for_each_row([&](int thread, Index i, std::span<const double> blocks) {
      CoarseBlocks<D>& part = parts[std::size_t(thread)];
      const Index own = piece[i];
      const Motions at_i = motions_at<D>(i);
      part.between(own, own).noalias() +=
          at_i * Entries(&tangent.diagonal[std::size_t(i) * D * D]) * at_i.transpose();
      // K_ij Q_j is added up over partners of the same piece, which mostly follow one another.
      Motions of_run = Motions::Zero();
      Index run = FreeDofs::none;
      const auto end_run = [&] {
        if (run == FreeDofs::none) return;
        const Eigen::Matrix<double, motions, motions> block = at_i * of_run.transpose();
        if (run == own) {
          part.between(own, own) += block + block.transpose();
        } else if (run < own) {
          part.between(own, run) += block;
        } else {
          part.between(run, own) += block.transpose();
        }
        of_run.setZero();
      };
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const Index j = pattern.partner[bond];
        if (piece[j] != run) {
          end_run();
          run = piece[j];
        }
        of_run.noalias() +=
            motions_at<D>(j) *
            Entries(&blocks[std::size_t(bond - pattern.offset[i]) * D * D]).transpose();
      }
      end_run();
    });
    std::vector<Eigen::Triplet<double, Long>> triplets;
    for (const CoarseBlocks<D>& part : parts) {
      part.for_each([&](Index a, Index b, const auto& block) {
        for (int c = 0; c < first[b + 1] - first[b]; ++c) {
          for (int r = a == b ? c : 0; r < first[a + 1] - first[a]; ++r) {
            triplets.emplace_back(first[a] + r, first[b] + c, block(r, c));
          }
        }
      });
    }
    Matrix matrix(first.back(), first.back());
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    for (Index k = 0; k < first.back(); ++k) {
      // A coarse equation always has its diagonal entry.
      matrix.coeffRef(k, k) *= 1.0 + relative_shift;
    }
    return matrix;
  }

  template <int D>
  LinearOutcome build_coarse(const TangentOperator& tangent) {
    find_basis<D>(tangent);
    if (first.back() == 0) return LinearOutcome::solved;
    coarse.compute(coarse_matrix<D>(tangent));
    const int status = coarse.cholmod().status;
    if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE) {
      return LinearOutcome::out_of_memory;
    }
    if (coarse.info() != Eigen::Success) return LinearOutcome::not_positive_definite;
    coarse_residual.resize(first.back());
    return LinearOutcome::solved;
  }

  template <int D>
  void add_coarse(std::span<const double> residual, std::span<double> correction) {
    constexpr int motions = motions_of(D);
    const Index pieces = static_cast<Index>(first.size()) - 1;
    const auto for_each_row = [&](Index p, const auto& visit) {
      for (Index place = offset[p]; place < offset[p + 1]; ++place) {
        for (int c = 0; c < D; ++c) {
          const Index e = free->equation[std::size_t(member[place]) * D + c];
          if (e != FreeDofs::none) visit(e, &basis[std::size_t(e) * motions]);
        }
      }
    };
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      std::array<double, motions> sum{};
      for_each_row(p, [&](Index e, const double* row) {
        for (int m = 0; m < motions; ++m) sum[m] += row[m] * residual[e];
      });
      for (Index k = first[p]; k < first[p + 1]; ++k) coarse_residual[k] = sum[k - first[p]];
    }
    coarse_correction = coarse.solve(coarse_residual);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      std::array<double, motions> amount{};
      for (Index k = first[p]; k < first[p + 1]; ++k) amount[k - first[p]] = coarse_correction[k];
      for_each_row(p, [&](Index e, const double* row) {
        for (int m = 0; m < motions; ++m) correction[e] += row[m] * amount[m];
      });
    }
  }
};

RigidPieces::RigidPieces() : levels_(std::make_unique<Levels>()) {
  levels_->coarse.cholmod().print = 0;  // negative pivots are an outcome, no warning
}
RigidPieces::~RigidPieces() = default;

void RigidPieces::analyze(const Pattern& pattern, const FreeDofs& free) {
  levels_->free = &free;
  levels_->dimension = free.dimension;
  levels_->box.clear();
  levels_->fine.analyze(pattern, free);
}

LinearOutcome RigidPieces::build(const TangentOperator& tangent) {
  Levels& levels = *levels_;
  levels.threads = tangent.threads();
  levels.first.assign(1, 0);
  const LinearOutcome outcome = levels.fine.build(tangent);
  if (outcome != LinearOutcome::solved) return outcome;
  if (levels.box.empty()) levels.find_boxes(tangent);
  levels.find_pieces(tangent);
  if (tangent.dimension == 1) return levels.build_coarse<1>(tangent);
  if (tangent.dimension == 2) return levels.build_coarse<2>(tangent);
  return levels.build_coarse<3>(tangent);
}

void RigidPieces::apply(std::span<const double> residual, std::span<double> correction) {
  Levels& levels = *levels_;
  levels.fine.apply(residual, correction);
  if (levels.first.back() == 0) return;
  if (levels.dimension == 1) levels.add_coarse<1>(residual, correction);
  if (levels.dimension == 2) levels.add_coarse<2>(residual, correction);
  if (levels.dimension == 3) levels.add_coarse<3>(residual, correction);
}

std::string RigidPieces::describe() const {
  if (levels_->offset.empty()) return "rigid pieces";
  return fmt::format("{} rigid pieces", levels_->offset.size() - 1);
}

}  // namespace peristat
