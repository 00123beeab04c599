#include "solvers/linear/rigid_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>

#include <Eigen/CholmodSupport>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <fmt/format.h>
#include <omp.h>

#include "assembly/operators/constrained_tangent.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/gathered_pieces.hpp"
#include "solvers/linear/worst_outcome.hpp"
#include "src/geometry/squared_distance.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

using Long = SuiteSparse_long;
using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Long>;

/// Width of the boxes that the body is divided into, in horizons, and its lower limit, in lengths
/// of the shortest bond. Smaller boxes need fewer iterations and have a larger coarse matrix.
constexpr double box_in_horizons = 5.0 / 3.0, box_in_spacings = 2.5;

/// True if the coarse factor of a grid of boxes is too large for a body; the boxes are then made
/// wider.
/// @param boxes number along each direction
/// @param points number in the whole body
/// @param ranks number that share the points; one of them stores the factor
bool is_too_fine(int dimension, const std::array<double, 3>& boxes, double points, int ranks) {
  const double all = boxes[0] * boxes[1] * boxes[2];
  if (dimension < 3) return all > (dimension == 1 ? 1e6 : 2e5);
  // Number of 6 x 6 blocks in the factor: that of nested dissection, or within the band of a
  // slender body.
  const double section = all / *std::max_element(boxes.begin(), boxes.end());
  const double blocks = std::min(8.0 * std::pow(all, 4.0 / 3.0), 2.0 * section * all);
  constexpr double bytes_per_point = 100.0, bytes_of_block = 36.0 * 8.0, most_shares = 16.0;
  const double share = std::min(1.0, most_shares / double(ranks));
  return bytes_of_block * blocks > bytes_per_point * share * points && all > 1.0;
}

/// A motion is dropped as linearly dependent if the others leave less than this of its length.
constexpr double dependent = 1e-6;

/// A bond is broken if its block is below this fraction of the diagonal of its points.
constexpr double broken = 1e-9;

/// Shift of the diagonal of E that avoids zero pivots of motions without stiffness; far below what
/// changes a correction.
constexpr double relative_shift = 1e-12;

constexpr int motions_of(int dimension) { return dimension * (dimension + 1) / 2; }

/// Contribution of a vector at a point to the rigid motions about a centre: the vector itself to
/// the translations, its moments in the planes of the axes to the rotations.
template <int D>
std::array<double, motions_of(D)> moments(const float* arm, const std::array<double, D>& vector) {
  std::array<double, motions_of(D)> result{};
  for (int c = 0; c < D; ++c) result[c] = vector[c];
  for (int m = D; m < motions_of(D); ++m) {
    const int a = D == 2 ? 0 : m - D, b = D == 2 ? 1 : (a + 1) % 3;
    result[m] = arm[a] * vector[b] - arm[b] * vector[a];
  }
  return result;
}

/// The transposed map: displacement of a point for given amounts of the motions.
template <int D>
std::array<double, D> displacement(const float* arm,
                                   const std::array<double, motions_of(D)>& amount) {
  std::array<double, D> result;
  for (int c = 0; c < D; ++c) result[c] = amount[c];
  for (int m = D; m < motions_of(D); ++m) {
    const int a = D == 2 ? 0 : m - D, b = D == 2 ? 1 : (a + 1) % 3;
    result[a] -= amount[m] * arm[b];
    result[b] += amount[m] * arm[a];
  }
  return result;
}

Index root(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

struct RigidPieces::Levels {
  explicit Levels(const IndexMap& of) : index_map(of) {}

  const FreeDofs* free = nullptr;
  const IndexMap& index_map;
  // Of a partitioned body; a whole one has neither ghosts nor handles apart from points.
  Index first_ghost = std::numeric_limits<Index>::max(), first_handle = first_ghost;
  std::vector<Index> with_ghosts;   // of a partitioned body: equations, 0 for free dofs of ghosts
  const Index* equation = nullptr;  // per degree of freedom: equation of this rank, or none
  GatheredPieces gathered_pieces;
  BlockJacobi fine{BlockJacobi::Blocks::points};
  Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower> coarse;
  std::vector<Index> box;    // per point and handle
  std::vector<Index> piece;  // likewise; none: a ghost or a handle that no bond here reaches
  /// Points x dimension, from the centre of their piece: Q is computed from them whenever it is
  /// needed. Single precision suffices, since it only selects a subspace.
  std::vector<float> arm;
  /// Pieces of the body x motions x motions: column k has the amounts of the piece's motions in its
  /// k-th orthonormal one. This, `first` and the factor exist where pieces are gathered.
  std::vector<double> to_basis;
  std::vector<Index> first;   // first coarse equation of each piece, and their number
  std::vector<Index> member;  // points and handles of this rank, grouped by its pieces
  std::vector<Index> offset;  // start in `member` of each piece here
  Eigen::VectorXd coarse_residual, coarse_correction;
  bool has_boxes = false;     // for the present pattern
  bool is_fine_alone = true;  // there are no coarse equations
  double length_unit = 1.0;   // of the arms [m]: keeps them within what single precision holds
  int dimension = 0, threads = 1;

  /// True for a ghost of a partitioned body: its owner also has the blocks of its bonds.
  [[nodiscard]] bool is_ghost(Index i) const { return i >= first_ghost && i < first_handle; }
  /// True if the equations of a point, or of a generalised degree of freedom, are this rank's.
  [[nodiscard]] bool has_row(Index i) const {
    return i < first_ghost || (i >= first_handle && index_map.is_first_rank());
  }
  [[nodiscard]] Index pieces_here() const { return static_cast<Index>(offset.size()) - 1; }

  /// For a partitioned body, finds which degrees of freedom of ghosts have equations on their
  /// owner.
  void take_part() {
    equation = free->equation.data();
    if (index_map.is_whole()) return;
    first_ghost = index_map.owned();
    first_handle = index_map.count();
    std::vector<double> is_free(free->equation.size());
    for (std::size_t k = 0; k < is_free.size(); ++k) {
      is_free[k] = free->equation[k] == FreeDofs::none ? 0.0 : 1.0;
    }
    index_map.update_ghosts(is_free);
    with_ghosts = free->equation;
    for (std::size_t k = 0; k < is_free.size(); ++k) {
      if (with_ghosts[k] == FreeDofs::none && is_free[k] > 0.0) with_ghosts[k] = 0;
    }
    equation = with_ghosts.data();
  }

  /// Finds the boxes in the reference configuration, so that they depend neither on when the solver
  /// was made nor on the ranks.
  void find_boxes(const TangentOperator& tangent, std::span<const double> position) {
    const int d = dimension;
    const Couplings in_place = couplings_in_place(tangent);
    const Index own = index_map.own_rows(in_place.points());
    double longest = 0.0, shortest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < own; ++i) {
      for (const Index j : in_place.of(i)) {
        const double squared = squared_distance(position, d, i, j);
        longest = std::max(longest, squared);
        shortest = std::min(shortest, squared);
      }
    }
    std::array<double, 3> least, most, count{1.0, 1.0, 1.0};
    least.fill(std::numeric_limits<double>::infinity());
    most.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < std::size_t(own) * std::size_t(d); ++k) {
      least[k % d] = std::min(least[k % d], position[k]);
      most[k % d] = std::max(most[k % d], position[k]);
    }
    const double all = double(index_map.ranks().count_all(own).all);
    const std::vector<double> ends = index_map.ranks().max(
        {longest, -shortest, most[0], most[1], most[2], -least[0], -least[1], -least[2]});
    longest = ends[0];
    shortest = -ends[1];
    for (std::size_t c = 0; c < 3; ++c) {
      most[c] = ends[2 + c];
      least[c] = -ends[5 + c];
    }
    longest = std::sqrt(longest);
    length_unit = longest > 0.0 ? longest : 1.0;
    shortest = std::sqrt(std::min(shortest, longest * longest));
    double width = std::max({box_in_horizons * longest, box_in_spacings * shortest,
                             std::numeric_limits<double>::min()});
    do {
      for (int c = 0; c < d; ++c) {
        count[c] = std::max(1.0, std::round((most[c] - least[c] + shortest) / width));
      }
      width *= 1.1;
    } while (is_too_fine(d, count, all, index_map.ranks().count()));
    has_boxes = true;
    box.resize(std::size_t(tangent.pattern.points()));
    for (Index i = 0; i < tangent.pattern.points(); ++i) {
      if (i >= in_place.points()) {  // handles are pieces by themselves
        box[i] = -1 - i;
        continue;
      }
      double number = 0.0;
      for (int c = 0; c < d; ++c) {
        const double extent = most[c] - least[c];
        const double share =
            extent > 0.0 ? (position[std::size_t(i) * d + c] - least[c]) / extent : 0.0;
        number = number * count[c] + std::min(std::floor(share * count[c]), count[c] - 1.0);
      }
      box[i] = static_cast<Index>(number);
    }
  }

  /// Returns the traces of the diagonal blocks of ghosts, as their owners have them.
  [[nodiscard]] std::vector<double> traces_of_ghosts(const TangentOperator& tangent) const {
    if (index_map.is_whole()) return {};
    std::vector<double> traces(std::size_t(tangent.pattern.points()));
    for (Index i = 0; i < index_map.owned(); ++i) traces[std::size_t(i)] = trace(tangent, i);
    index_map.update_ghost_values(traces);
    traces.erase(traces.begin(), traces.begin() + std::ptrdiff_t(index_map.owned()));
    return traces;
  }

  [[nodiscard]] static double trace(const TangentOperator& tangent, Index i) {
    const int d = tangent.dimension;
    double sum = 0.0;
    for (int c = 0; c < d; ++c) sum += tangent.diagonal[std::size_t(i) * (d * d) + c * (d + 1)];
    return sum;
  }

  /// Joins points that unbroken bonds connect within their box; returns a representative for each.
  [[nodiscard]] std::vector<Index> join_in_boxes(const TangentOperator& tangent) const {
    const BlockPattern& pattern = tangent.pattern;
    const int entries = dimension * dimension;
    const Index points = pattern.points(), own = index_map.own_rows(points);
    const std::vector<double> of_ghosts = traces_of_ghosts(tangent);
    const auto trace_of = [&](Index i) {
      return i < own ? trace(tangent, i) : of_ghosts[std::size_t(i - own)];
    };
    std::vector<Index> parent(points);
    std::iota(parent.begin(), parent.end(), 0);
    const auto join = [&](Index i, Index j) { parent[root(parent, i)] = root(parent, j); };
    // Bonds to points of later parts are joined at the end.
    std::vector<std::vector<std::pair<Index, Index>>> across(std::size_t(tangent.parts()));
    tangent.for_each_row([&](int part, Index i, std::span<const double> blocks) {
      if (!has_row(i)) return;
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const Index j = pattern.partner(i, bond);
        if (box[i] != box[j]) continue;
        const double* block = &blocks[std::size_t(bond - pattern.offset[i]) * entries];
        double largest = 0.0;
        for (int k = 0; k < entries; ++k) largest = std::max(largest, std::abs(block[k]));
        if (!(largest > broken * std::min(trace_of(i), trace_of(j)))) continue;
        if (j < tangent.ranges[std::size_t(part)].last) {
          join(i, j);
        } else {
          across[std::size_t(part)].emplace_back(i, j);
        }
      }
    });
    for (const auto& pairs : across) {
      for (const auto& [i, j] : pairs) join(i, j);
    }
    for (Index i = 0; i < points; ++i) parent[i] = root(parent, i);
    return parent;
  }

  /// Numbers the pieces of this rank in the order of their points; ghosts that no bond here reaches
  /// have none.
  /// @return number of pieces
  Index number_pieces_of_part(const TangentOperator& tangent, const std::vector<Index>& joined) {
    const BlockPattern& pattern = tangent.pattern;
    const Index points = pattern.points(), own = index_map.owned();
    std::vector<char> is_reached(std::size_t(points), 0);
    for (Index i = 0; i < points; ++i) is_reached[std::size_t(i)] = char(has_row(i));
    for (Index i = 0; i < own; ++i) {
      for (const Index j : pattern.of(i)) is_reached[std::size_t(j)] = 1;
    }
    const std::vector<std::int64_t> labels = labels_over_ranks(index_map, joined);
    std::unordered_map<std::int64_t, Index> number;
    std::vector<std::int64_t> of_pieces;
    piece.assign(points, FreeDofs::none);
    for (Index i = 0; i < points; ++i) {
      if (!is_reached[std::size_t(i)]) continue;
      const auto [at, is_new] = number.try_emplace(labels[std::size_t(i)], Index(of_pieces.size()));
      if (is_new) of_pieces.push_back(labels[std::size_t(i)]);
      piece[i] = at->second;
    }
    gathered_pieces = GatheredPieces(index_map.ranks(), of_pieces);
    return Index(of_pieces.size());
  }

  /// Finds the pieces: parts of the boxes that unbroken bonds join.
  void find_pieces(const TangentOperator& tangent) {
    const Index points = tangent.pattern.points();
    const std::vector<Index> joined = join_in_boxes(tangent);
    Index pieces = 0;
    if (!index_map.is_whole()) {
      pieces = number_pieces_of_part(tangent, joined);
    } else {
      std::vector<Index> number(points, FreeDofs::none);
      piece.resize(points);
      for (Index i = 0; i < points; ++i) {
        Index& of_root = number[joined[i]];
        if (of_root < 0) of_root = pieces++;
        piece[i] = of_root;
      }
      gathered_pieces = GatheredPieces(pieces);
    }
    offset.assign(std::size_t(pieces) + 1, 0);
    for (Index i = 0; i < points; ++i) {
      if (has_row(i)) ++offset[piece[i] + 1];
    }
    std::partial_sum(offset.begin(), offset.end(), offset.begin());
    member.resize(std::size_t(offset.back()));
    std::vector<Index> place(offset.begin(), offset.end() - 1);
    for (Index i = 0; i < points; ++i) {
      if (has_row(i)) member[place[piece[i]]++] = i;
    }
  }

  /// Vector of a point's degrees of freedom, 0 where one is prescribed.
  template <int D, class ValueOf>
  std::array<double, D> at_free(Index i, const ValueOf& value_of) const {
    std::array<double, D> result;
    for (int c = 0; c < D; ++c) {
      const Index e = equation[std::size_t(i) * D + c];
      result[c] = e == FreeDofs::none ? 0.0 : value_of(c, e);
    }
    return result;
  }

  /// Motions of a point's piece at the point: motions x D, zero where a component is prescribed.
  template <int D>
  Eigen::Matrix<double, motions_of(D), D> motions_at(Index i) const {
    Eigen::Matrix<double, motions_of(D), D> result;
    for (int c = 0; c < D; ++c) {
      const std::array<double, D> unit =
          at_free<D>(i, [c](int component, Index) { return component == c ? 1.0 : 0.0; });
      const auto column = moments<D>(&arm[std::size_t(i) * D], unit);
      for (int m = 0; m < motions_of(D); ++m) result(m, c) = column[m];
    }
    return result;
  }

  template <int D>
  auto basis_of(Index p) {
    constexpr int motions = motions_of(D);
    return Eigen::Map<Eigen::Matrix<double, motions, motions>>(
        &to_basis[std::size_t(p) * motions * motions]);
  }

  [[nodiscard]] std::span<const Index> members(Index p) const {
    return std::span<const Index>(member).subspan(std::size_t(offset[p]),
                                                  std::size_t(offset[p + 1] - offset[p]));
  }

  /// Finds the arms of all points with a piece, from its centre.
  template <int D>
  void find_arms(std::span<const double> position) {
    const Index pieces = pieces_here();
    std::vector<double> sums(std::size_t(pieces) * (D + 1), 0.0);  // positions, count
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      double* const of_piece = &sums[std::size_t(p) * (D + 1)];
      for (const Index i : members(p)) {
        for (int c = 0; c < D; ++c) of_piece[c] += position[std::size_t(i) * D + c];
      }
      of_piece[D] = double(members(p).size());
    }
    sums = gathered_pieces.share_out(gathered_pieces.sum(std::move(sums), D + 1), D + 1);
    arm.resize(position.size());
    const Index points = static_cast<Index>(piece.size());
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index i = 0; i < points; ++i) {
      if (piece[i] == FreeDofs::none) continue;
      const double* const of_piece = &sums[std::size_t(piece[i]) * (D + 1)];
      for (int c = 0; c < D; ++c) {
        const std::size_t dof = std::size_t(i) * D + c;
        arm[dof] = static_cast<float>((position[dof] - of_piece[c] / of_piece[D]) / length_unit);
      }
    }
  }

  /// Returns the Gram matrices of the pieces' motions on their equations.
  template <int D>
  std::vector<double> find_grams() {
    constexpr int motions = motions_of(D), entries = motions * motions;
    const Index pieces = pieces_here();
    std::vector<double> grams(std::size_t(pieces) * entries, 0.0);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      Eigen::Matrix<double, motions, motions> gram;
      gram.setZero();
      for (const Index i : members(p)) {
        const auto at_i = motions_at<D>(i);
        gram.noalias() += at_i * at_i.transpose();
      }
      std::copy_n(gram.data(), entries, &grams[std::size_t(p) * entries]);
    }
    return gathered_pieces.sum(std::move(grams), entries);
  }

  /// Finds orthonormal motions of each piece on its equations, by the Gram-Schmidt method done
  /// twice.
  template <int D>
  void find_basis(std::vector<double> grams) {
    constexpr int motions = motions_of(D), entries = motions * motions;
    using Vector = Eigen::Matrix<double, motions, 1>;
    const Index pieces = static_cast<Index>(grams.size() / entries);
    to_basis.assign(grams.size(), 0.0);
    first.assign(std::size_t(pieces) + 1, 0);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      Eigen::Matrix<double, motions, motions> gram;
      std::copy_n(&grams[std::size_t(p) * entries], entries, gram.data());
      auto basis = basis_of<D>(p);
      int kept = 0;
      for (int m = 0; m < motions; ++m) {
        Vector motion = Vector::Unit(m);
        for (int sweep = 0; sweep < 2; ++sweep) {
          for (int k = 0; k < kept; ++k) {
            motion -= basis.col(k).dot(gram * motion) * Vector(basis.col(k));
          }
        }
        const double squared = motion.dot(gram * motion);
        if (!(squared > dependent * dependent * gram(m, m) && squared > 0.0)) continue;
        basis.col(kept++) = motion / std::sqrt(squared);
      }
      first[p + 1] = kept;
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
  }

  /// Blocks of E between two pieces, accumulated by one part.
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

  /// Returns the blocks of the lower triangle of E by parts, or gathered from all ranks.
  template <int D>
  std::vector<CoarseBlocks<D>> coarse_blocks(const TangentOperator& tangent) const {
    constexpr int motions = motions_of(D);
    using Motions = Eigen::Matrix<double, motions, D>;
    using Entries = Eigen::Map<const Eigen::Matrix<double, D, D, Eigen::RowMajor>>;
    const BlockPattern& pattern = tangent.pattern;
    std::vector<CoarseBlocks<D>> parts(std::size_t(tangent.parts()));
    tangent.for_each_row([&](int part, Index i, std::span<const double> blocks) {
      if (!has_row(i)) return;
      CoarseBlocks<D>& of_part = parts[std::size_t(part)];
      const Index own = piece[i];
      const Motions at_i = motions_at<D>(i);
      of_part.between(own, own).noalias() +=
          at_i * Entries(&tangent.diagonal[std::size_t(i) * D * D]) * at_i.transpose();
      // K_ij times the motions at j, transposed, is summed over successive partners of the same
      // piece, because partners of one piece mostly follow one another.
      Motions of_run = Motions::Zero();
      Index run = FreeDofs::none;
      bool is_shared = false;
      const auto end_run = [&] {
        if (run == FreeDofs::none) return;
        if (is_shared) of_run *= 0.5;  // the rank that owns the ghosts has the other half
        const Eigen::Matrix<double, motions, motions> block = at_i * of_run.transpose();
        if (run == own) {
          of_part.between(own, own) += block + block.transpose();
        } else if (run < own) {
          of_part.between(own, run) += block;
        } else {
          of_part.between(run, own) += block.transpose();
        }
        of_run.setZero();
      };
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const Index j = pattern.partner(i, bond);
        if (piece[j] != run || is_ghost(j) != is_shared) {
          end_run();
          run = piece[j];
          is_shared = is_ghost(j);
        }
        const double* block = &blocks[std::size_t(bond - pattern.offset[i]) * D * D];
        for (int r = 0; r < D; ++r) {
          const auto column =
              moments<D>(&arm[std::size_t(j) * D],
                         at_free<D>(j, [&](int c, Index) { return block[r * D + c]; }));
          for (int m = 0; m < motions; ++m) of_run(m, r) += column[m];
        }
      }
      end_run();
    });
    return index_map.is_whole() ? parts : of_ranks<D>(parts);
  }

  template <int D>
  std::vector<CoarseBlocks<D>> of_ranks(const std::vector<CoarseBlocks<D>>& parts) const {
    using Block = typename CoarseBlocks<D>::Block;
    GatheredPieces::Pairs pairs;
    for (const CoarseBlocks<D>& part : parts) {
      part.for_each([&](Index a, Index b, const Block& block) {
        pairs.row.push_back(a);
        pairs.column.push_back(b);
        pairs.values.insert(pairs.values.end(), block.data(), block.data() + block.size());
      });
    }
    std::vector<CoarseBlocks<D>> gathered(1);
    gathered_pieces.for_each_pair(std::move(pairs), int(Block::SizeAtCompileTime),
                                  [&](Index a, Index b, const double* values) {
                                    const Eigen::Map<const Block> block(values);
                                    if (a >= b) {
                                      gathered[0].between(a, b) += block;
                                    } else {
                                      gathered[0].between(b, a) += block.transpose();
                                    }
                                  });
    return gathered;
  }

  /// Assembles the lower triangle of E from its blocks, which are in terms of the pieces' motions,
  /// not of the orthonormal basis.
  template <int D>
  Matrix gathered(const std::vector<CoarseBlocks<D>>& parts) {
    using Block = typename CoarseBlocks<D>::Block;
    struct Part {
      Index row, column;  // pieces
      const Block* block;
    };
    std::vector<Part> all;
    for (const CoarseBlocks<D>& part : parts) {
      part.for_each([&](Index a, Index b, const Block& block) { all.push_back({a, b, &block}); });
    }
    // Stable: what the parts have of a block is added in the order of the parts.
    std::stable_sort(all.begin(), all.end(), [](const Part& a, const Part& b) {
      return std::pair(a.column, a.row) < std::pair(b.column, b.row);
    });
    const auto kept = [&](Index p) { return first[p + 1] - first[p]; };
    // visit(row, column, what the parts have of the block), columns ascending and their rows, too.
    const auto for_each_block = [&](const auto& visit) {
      for (std::size_t k = 0; k < all.size();) {
        std::size_t end = k + 1;
        while (end < all.size() && all[end].row == all[k].row && all[end].column == all[k].column) {
          ++end;
        }
        visit(all[k].row, all[k].column, std::span<const Part>(&all[k], end - k));
        k = end;
      }
    };
    Matrix matrix(first.back(), first.back());
    Long* const begin = matrix.outerIndexPtr();
    std::fill(begin, begin + first.back() + 1, 0);
    for_each_block([&](Index a, Index b, std::span<const Part>) {
      for (int c = 0; c < kept(b); ++c) begin[first[b] + c + 1] += kept(a) - (a == b ? c : 0);
    });
    std::partial_sum(begin, begin + first.back() + 1, begin);
    matrix.resizeNonZeros(begin[first.back()]);
    std::vector<Long> next(begin, begin + first.back());
    for_each_block([&](Index a, Index b, std::span<const Part> run) {
      Block block = *run.front().block;
      for (const Part& part : run.subspan(1)) block += *part.block;
      const Block entries = basis_of<D>(a).transpose() * block * basis_of<D>(b);
      for (int c = 0; c < kept(b); ++c) {
        for (int r = a == b ? c : 0; r < kept(a); ++r) {
          Long& place = next[std::size_t(first[b] + c)];
          matrix.innerIndexPtr()[place] = first[a] + r;
          const bool on_diagonal = a == b && r == c;
          matrix.valuePtr()[place++] = entries(r, c) * (on_diagonal ? 1.0 + relative_shift : 1.0);
        }
      }
    });
    return matrix;
  }

  template <int D>
  LinearOutcome build_coarse(const TangentOperator& tangent) {
    find_arms<D>(tangent.positions());
    find_basis<D>(find_grams<D>());
    is_fine_alone = index_map.ranks().max(double(first.back())) == 0.0;
    if (is_fine_alone) return LinearOutcome::solved;
    const std::vector<CoarseBlocks<D>> blocks = coarse_blocks<D>(tangent);
    if (!gathered_pieces.gathers()) return LinearOutcome::solved;
    coarse.compute(gathered<D>(blocks));
    const int status = coarse.cholmod().status;
    if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE) {
      return LinearOutcome::out_of_memory;
    }
    if (coarse.info() != Eigen::Success) return LinearOutcome::not_positive_definite;
    coarse_residual.resize(first.back());
    return LinearOutcome::solved;
  }

  /// Applies E^-1 to the moments of all pieces, in place: the result is the amounts of their
  /// motions.
  template <int D>
  void solve_coarse(std::vector<double>& of_pieces) {
    constexpr int motions = motions_of(D);
    using Vector = Eigen::Matrix<double, motions, 1>;
    const Index pieces = static_cast<Index>(first.size()) - 1;
    const auto of_piece = [&](Index p) {
      return Eigen::Map<Vector>(&of_pieces[std::size_t(p) * motions]);
    };
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      const Vector sum = of_piece(p);
      const Vector in_basis = basis_of<D>(p).transpose() * sum;
      for (Index k = first[p]; k < first[p + 1]; ++k) coarse_residual[k] = in_basis[k - first[p]];
    }
    coarse_correction = coarse.solve(coarse_residual);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      Vector in_basis = Vector::Zero();
      for (Index k = first[p]; k < first[p + 1]; ++k) in_basis[k - first[p]] = coarse_correction[k];
      const Vector amount = basis_of<D>(p) * in_basis;
      of_piece(p) = amount;
    }
  }

  template <int D>
  void add_coarse(std::span<const double> residual, std::span<double> correction) {
    constexpr int motions = motions_of(D);
    const Index pieces = pieces_here();
    std::vector<double> of_pieces(std::size_t(pieces) * motions, 0.0);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      double* const sum = &of_pieces[std::size_t(p) * motions];
      for (const Index i : members(p)) {
        const auto at_i = moments<D>(&arm[std::size_t(i) * D],
                                     at_free<D>(i, [&](int, Index e) { return residual[e]; }));
        for (int m = 0; m < motions; ++m) sum[m] += at_i[m];
      }
    }
    of_pieces = gathered_pieces.sum(std::move(of_pieces), motions);
    if (gathered_pieces.gathers()) solve_coarse<D>(of_pieces);
    of_pieces = gathered_pieces.share_out(std::move(of_pieces), motions);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      std::array<double, motions> amount;
      for (int m = 0; m < motions; ++m) amount[m] = of_pieces[std::size_t(p) * motions + m];
      for (const Index i : members(p)) {
        const std::array<double, D> moved = displacement<D>(&arm[std::size_t(i) * D], amount);
        for (int c = 0; c < D; ++c) {
          const Index e = free->equation[std::size_t(i) * D + c];
          if (e != FreeDofs::none) correction[e] += moved[c];
        }
      }
    }
  }
};

RigidPieces::RigidPieces(const IndexMap& index_map) : levels_(std::make_unique<Levels>(index_map)) {
  levels_->coarse.cholmod().print = 0;  // negative pivots are an outcome, not a warning
}
RigidPieces::~RigidPieces() = default;

void RigidPieces::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  levels_->free = &free;
  levels_->dimension = free.dimension;
  levels_->has_boxes = false;
  levels_->fine.analyze(pattern, free);
}

LinearOutcome RigidPieces::build(const TangentOperator& tangent) {
  Levels& levels = *levels_;
  levels.threads = tangent.threads();
  levels.is_fine_alone = true;
  levels.take_part();
  const LinearOutcome outcome = worst_outcome(levels.index_map.ranks(), levels.fine.build(tangent));
  if (outcome != LinearOutcome::solved) return outcome;
  if (!levels.has_boxes) levels.find_boxes(tangent, tangent.reference);
  levels.find_pieces(tangent);
  if (tangent.dimension == 1) return levels.build_coarse<1>(tangent);
  if (tangent.dimension == 2) return levels.build_coarse<2>(tangent);
  return levels.build_coarse<3>(tangent);
}

void RigidPieces::apply(std::span<const double> residual, std::span<double> correction) {
  Levels& levels = *levels_;
  levels.fine.apply(residual, correction);
  if (levels.is_fine_alone) return;
  if (levels.dimension == 1) levels.add_coarse<1>(residual, correction);
  if (levels.dimension == 2) levels.add_coarse<2>(residual, correction);
  if (levels.dimension == 3) levels.add_coarse<3>(residual, correction);
}

std::string RigidPieces::describe() const {
  if (levels_->offset.empty()) return "rigid pieces";
  return fmt::format("{} rigid pieces", levels_->gathered_pieces.count());
}

}  // namespace peristat
