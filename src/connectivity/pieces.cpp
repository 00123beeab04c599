#include "src/connectivity/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "src/connectivity/free_motion.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Joins components of all ranks that ghosts connect: maps each label to the lowest one of its
/// piece.
std::map<double, double> join(const Communicator& ranks,
                              const std::set<std::pair<double, double>>& mine) {
  std::vector<double> flat;
  for (const auto& [a, b] : mine) flat.insert(flat.end(), {a, b});
  flat = concatenated(ranks, flat);
  std::map<double, double> parent;
  for (const double label : flat) parent.emplace(label, label);
  const auto root = [&](double label) {
    while (parent[label] != label) label = parent[label] = parent[parent[label]];
    return label;
  };
  for (std::size_t k = 0; k < flat.size(); k += 2) {
    const double a = root(flat[k]), b = root(flat[k + 1]);
    parent[std::max(a, b)] = std::min(a, b);
  }
  for (auto& [label, of] : parent) of = root(label);
  return parent;
}

/// Connects the components of points that are tied across ranks (Holding::ties) to the lowest one.
void add_ties(const Communicator& ranks, const std::vector<double>& label,
              std::span<const Index> tied, std::set<std::pair<double, double>>& ties) {
  std::vector<double> mine;
  for (const Index point : tied) {
    mine.push_back(point >= 0 ? label[std::size_t(point)]
                              : std::numeric_limits<double>::infinity());
  }
  if (mine.empty()) return;
  const std::vector<double> lowest = ranks.min(mine);
  for (std::size_t k = 0; k < mine.size(); ++k) {
    if (std::isfinite(mine[k]) && mine[k] != lowest[k]) ties.emplace(mine[k], lowest[k]);
  }
}

/// Returns for each component here the number of the shared piece that it is a part of, or -1; and
/// the number of shared pieces.
std::pair<std::vector<Index>, std::size_t> shared_pieces(const Components& here,
                                                         std::span<const Index> tied,
                                                         const IndexMap& index_map) {
  const std::size_t own = std::min(std::size_t(index_map.owned()), here.of_point.size());
  const double first = double(index_map.ranks().count_all(std::int64_t(here.size.size())).before);
  std::vector<double> label(here.of_point.begin(), here.of_point.end());
  for (double& of_point : label) of_point += first;
  std::vector<double> of_owner = label;
  index_map.update_ghost_values(of_owner);
  std::vector<char> has_own(here.size.size(), 0);
  for (std::size_t i = 0; i < own; ++i) has_own[std::size_t(here.of_point[i])] = 1;
  std::set<std::pair<double, double>> ties;
  for (std::size_t ghost = own; ghost < label.size(); ++ghost) {
    const bool is_elsewhere = label[ghost] != of_owner[ghost];  // no image
    if (is_elsewhere && has_own[std::size_t(here.of_point[ghost])]) {
      ties.emplace(label[ghost], of_owner[ghost]);
    }
  }
  add_ties(index_map.ranks(), label, tied, ties);
  const std::map<double, double> joined = join(index_map.ranks(), ties);
  std::map<double, Index> number;  // by the lowest label
  for (const auto& [of, lowest] : joined) {
    if (of == lowest) number.emplace(lowest, Index(number.size()));
  }
  std::vector<Index> shared(here.size.size(), -1);
  for (std::size_t k = 0; k < shared.size(); ++k) {
    const auto found = joined.find(first + double(k));
    if (found != joined.end()) shared[k] = number.at(found->second);
  }
  return {shared, number.size()};
}

/// Sums the points of the shared pieces over all ranks and finds their lowest points.
void count_shared(std::span<Piece> pieces, const Communicator& ranks) {
  std::vector<double> points, lowest;
  for (const Piece& piece : pieces) {
    points.push_back(double(piece.points));
    lowest.push_back(piece.members.empty() ? std::numeric_limits<double>::infinity()
                                           : double(piece.lowest));
  }
  if (pieces.empty()) return;
  points = ranks.sum(points);
  lowest = ranks.min(lowest);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    pieces[k].points = GlobalIndex(points[k]);
    pieces[k].lowest = GlobalIndex(lowest[k]);
  }
}

std::span<const Piece> shared_of(const std::vector<Piece>& pieces) {
  const auto end = std::find_if_not(pieces.begin(), pieces.end(),
                                    [](const Piece& piece) { return piece.is_shared; });
  return {pieces.begin(), end};
}

}  // namespace

std::vector<Piece> pieces_of(const Points& points, const Bonds& bonds, std::span<const char> broken,
                             std::span<const BondEnds> links, std::span<const Index> ties,
                             const IndexMap& index_map) {
  const Components here = connected_components(bonds, broken, links);
  std::vector<std::vector<Index>> members = here.members();
  const auto [shared, count] = shared_pieces(here, ties, index_map);
  std::vector<Piece> pieces(count);
  for (Piece& piece : pieces) piece.is_shared = true;
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (!index_map.is_whole()) {
      const auto ghosts = std::lower_bound(members[k].begin(), members[k].end(), index_map.owned());
      members[k].erase(ghosts, members[k].end());
    }
    const bool is_here = !members[k].empty() && !points.is_image(members[k].front());
    if (!is_here) continue;  // ghosts of others' pieces, images
    Piece& piece = shared[k] >= 0 ? pieces[std::size_t(shared[k])] : pieces.emplace_back();
    piece.members.insert(piece.members.end(), members[k].begin(), members[k].end());
  }
  for (Piece& piece : pieces) {
    std::sort(piece.members.begin(), piece.members.end());  // from several components here
    const auto images = std::ranges::lower_bound(piece.members, points.own());
    piece.points = GlobalIndex(images - piece.members.begin());
    if (piece.members.empty()) continue;
    const Index first = piece.members.front();
    piece.lowest = index_map.number_of(first);
  }
  count_shared(std::span(pieces).first(count), index_map.ranks());
  return pieces;
}

Coordinates FreePieces::place(Index point) const {
  Coordinates at{};
  const auto d = std::size_t(points_.dimension);
  for (std::size_t c = 0; c < d; ++c) at[c] = positions_[std::size_t(point) * d + c];
  return at;
}

std::vector<RigidMotions> FreePieces::motions(const std::vector<Piece>& pieces) const {
  const std::span<const Piece> shared = shared_of(pieces);
  std::vector<RigidMotions> found = shared_motions(shared);
  for (const Piece& piece : std::span(pieces).subspan(shared.size())) {
    found.push_back(free_rigid_motions(points_.dimension, positions_, piece.members,
                                       holding_.prescribed, points_.spacing, holding_.motions));
  }
  return found;
}

std::vector<RigidMotions> FreePieces::shared_motions(std::span<const Piece> pieces) const {
  if (pieces.empty()) return {};
  const Communicator& ranks = index_map_.ranks();
  const auto d = std::size_t(points_.dimension);
  std::vector<double> centres, sizes;
  for (const Piece& piece : pieces) {
    Coordinates sum{};
    for (const Index i : piece.members) sum = plus<3>(sum, place(i));
    sum = scaled<3>(1.0 / double(piece.points), sum);
    centres.insert(centres.end(), sum.begin(), sum.end());
  }
  centres = ranks.sum(centres);
  std::vector<RigidMotions> about(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    about[k].dimension = points_.dimension;
    std::copy_n(centres.begin() + std::ptrdiff_t(3 * k), 3, about[k].centre.begin());
    double size = points_.spacing;
    for (const Index i : pieces[k].members) {
      const Coordinates arm = minus<3>(place(i), about[k].centre);
      size = std::max(size, std::sqrt(dot<3>(arm, arm)));
    }
    sizes.push_back(size);
  }
  sizes = ranks.max(sizes);
  std::vector<double> flat;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    about[k].size = sizes[k];
    MotionSums sums(points_.dimension);
    for (const Index i : pieces[k].members) {
      add_point(about[k], place(i), std::span(holding_.prescribed).subspan(std::size_t(i) * d, d),
                sums);
    }
    for (const HeldMotion& motion : holding_.motions) {
      const auto& members = pieces[k].members;
      if (std::binary_search(members.begin(), members.end(), motion.member)) {
        add_held(about[k], motion, sums);
      }
    }
    flat.insert(flat.end(), sums.moving.begin(), sums.moving.end());
    flat.insert(flat.end(), sums.held.begin(), sums.held.end());
  }
  flat = ranks.sum(flat);
  auto next = flat.begin();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    MotionSums sums(points_.dimension);
    sums.points = double(pieces[k].points);
    for (auto* entries : {&sums.moving, &sums.held}) {
      std::copy_n(next, entries->size(), entries->begin());
      next += std::ptrdiff_t(entries->size());
    }
    about[k] = free_rigid_motions(about[k], sums);
  }
  return about;
}

void FreePieces::pin(const std::vector<Piece>& pieces, const std::vector<RigidMotions>& motions,
                     const std::vector<char>& held, std::vector<char>& pinned) const {
  const std::span<const Piece> shared = shared_of(pieces);
  pin_shared(shared, std::span(motions).first(shared.size()), held, pinned);
  for (std::size_t k = shared.size(); k < pieces.size(); ++k) {
    for (const std::size_t dof :
         determinate_pins(motions[k], positions_, pieces[k].members, held, holding_.handles)) {
      pinned[dof] = 1;
    }
  }
  tell_pinned_handles(pinned);
}

void FreePieces::tell_pinned_handles(std::vector<char>& pinned) const {
  const auto handles = pinned.begin() + std::ptrdiff_t(points_.reference.size());
  if (handles == pinned.end()) return;
  const std::vector<double> all =
      index_map_.ranks().max(std::vector<double>(handles, pinned.end()));
  std::ranges::transform(all, handles, [](double pin) { return char(pin != 0.0); });
}

namespace {

/// Displacements of this rank's degrees of freedom in the motions of a shared piece: one row each,
/// from which pinned rows are projected out, as in determinate_pins.
struct MovedDofs {
  std::vector<std::size_t> dof;  // here
  std::vector<double> number;    // in the whole body
  std::vector<std::vector<double>> row;

  [[nodiscard]] static double norm(const std::vector<double>& of) {
    double squared = 0.0;
    for (const double entry : of) squared += entry * entry;
    return std::sqrt(squared);
  }
  [[nodiscard]] double most() const {
    double largest = 0.0;
    for (const auto& of_dof : row) largest = std::max(largest, norm(of_dof));
    return largest;
  }
  /// First row whose norm is `largest` within alike_displacements; the number of rows if there is
  /// none.
  [[nodiscard]] std::size_t lowest_alike(double largest) const {
    std::size_t k = 0;
    while (k < row.size() && largest > (1.0 + alike_displacements) * norm(row[k])) ++k;
    return k;
  }
  void take_out(const std::vector<double>& pin) {
    const double length = norm(pin);
    for (auto& of_dof : row) {
      double along = 0.0;
      for (std::size_t m = 0; m < pin.size(); ++m) along += of_dof[m] * pin[m] / length;
      for (std::size_t m = 0; m < pin.size(); ++m) of_dof[m] -= along * pin[m] / length;
    }
  }
};

}  // namespace

void FreePieces::pin_shared(std::span<const Piece> pieces, std::span<const RigidMotions> motions,
                            const std::vector<char>& held, std::vector<char>& pinned) const {
  if (pieces.empty()) return;
  constexpr double nobody = std::numeric_limits<double>::infinity();
  const auto d = std::size_t(points_.dimension);
  const std::size_t modes = d * (d + 1) / 2;
  const double first_handle =  // handles come after all points
      index_map_.ranks().sum(double(index_map_.owned())) - double(index_map_.count());
  int rounds = 0;
  std::vector<MovedDofs> moved(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    rounds = std::max(rounds, motions[k].count);
    if (motions[k].count == 0) continue;
    for (const Index i : pieces[k].members) {
      for (std::size_t c = 0; c < d; ++c) {
        const std::size_t dof = std::size_t(i) * d + c;
        if (held[dof]) continue;
        moved[k].dof.push_back(dof);
        moved[k].number.push_back(double(index_map_.number_of(i)) * double(d) + double(c));
        moved[k].row.push_back(moved_by(motions[k], place(i), int(c)));
      }
    }
    for (const FreeHandle& handle : holding_.handles) {
      const auto& members = pieces[k].members;
      if (!std::binary_search(members.begin(), members.end(), handle.moved_by.member)) continue;
      moved[k].dof.push_back(handle.dof);
      moved[k].number.push_back(first_handle * double(d) + double(handle.dof));
      moved[k].row.push_back(moved_by(motions[k], handle));
    }
  }
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> most, lowest, rows(pieces.size() * modes, 0.0);
    for (const MovedDofs& of : moved) most.push_back(of.most());
    most = index_map_.ranks().max(most);
    std::vector<std::size_t> mine;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      mine.push_back(moved[k].lowest_alike(most[k]));
      const bool has = round < motions[k].count && most[k] > displacement_at_rest &&
                       mine[k] < moved[k].row.size();
      lowest.push_back(has ? moved[k].number[mine[k]] : nobody);
    }
    const std::vector<double> chosen = index_map_.ranks().min(lowest);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (lowest[k] != chosen[k] || lowest[k] == nobody) continue;
      pinned[moved[k].dof[mine[k]]] = 1;
      const std::vector<double>& row = moved[k].row[mine[k]];
      std::copy(row.begin(), row.end(), rows.begin() + std::ptrdiff_t(k * modes));
    }
    rows = index_map_.ranks().sum(rows);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (chosen[k] == nobody) continue;
      const auto first = rows.begin() + std::ptrdiff_t(k * modes);
      moved[k].take_out({first, first + motions[k].count});
    }
  }
}

}  // namespace peristat
