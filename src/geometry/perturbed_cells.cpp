#include "src/geometry/perturbed_cells.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "src/core/counter_random.hpp"

namespace peristat {
namespace {

using Corner = std::array<double, 2>;  // in spacings from the middle of its cell

constexpr std::array<Corner, 4> unshifted{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};

/// Corners of the cells of a body, in the order of a cell's corners: anticlockwise.
class Corners {
 public:
  Corners(const Lattice& lattice, const std::vector<Site>& body)
      : lattice_(lattice), is_line_(lattice.dimension == 1) {
    cells_.reserve(body.size());
    for (const Site& site : body) cells_.push_back(site.cell);
  }

  [[nodiscard]] std::array<Corner, 4> of(const Cell& cell) const {
    std::array<Corner, 4> corners = unshifted;
    for (Corner& corner : corners) {
      const Cell above{cell[0] + (corner[0] > 0.0), cell[1] + (corner[1] > 0.0 && !is_line_), 0};
      const Corner shift = shift_of(above);
      for (std::size_t c = 0; c < 2; ++c) corner[c] += shift[c];
    }
    return corners;
  }

 private:
  /// @param above the cell whose lowest corner it is
  [[nodiscard]] Corner shift_of(const Cell& above) const {
    for (std::int64_t x = -1; x <= 0; ++x) {
      for (std::int64_t y = is_line_ ? 0 : -1; y <= 0; ++y) {
        const Cell cell{above[0] + x, above[1] + y, 0};
        if (!std::binary_search(cells_.begin(), cells_.end(), cell)) return {};
      }
    }
    std::uint64_t bits = lattice_.seed;
    for (const std::int64_t place : above) bits = random_bits(bits, std::uint64_t(place));
    Corner shift{};
    for (std::size_t c = 0; c < (is_line_ ? 1u : 2u); ++c) {
      shift[c] = lattice_.cell_perturbation * (2.0 * open_unit(random_bits(bits, c)) - 1.0);
    }
    return shift;
  }

  const Lattice& lattice_;
  bool is_line_;
  std::vector<Cell> cells_;
};

/// Converts a corner from spacings along the lattice's axes to the body's axes [m].
Corner in_body(const Lattice& lattice, const LatticeFrame& frame, const Corner& corner) {
  Coordinates along{};
  for (int c = 0; c < std::min(lattice.dimension, 2); ++c)
    along[std::size_t(c)] = corner[std::size_t(c)] * lattice.spacing.along(c);
  const Coordinates turned = frame.turned(along);
  return {turned[0], turned[1]};
}

/// A cell from its corners, relative to some place in spacings; for a line both ends.
std::vector<Corner> cell_from(const Lattice& lattice, const LatticeFrame& frame,
                              const std::array<Corner, 4>& corners, const Corner& about) {
  std::vector<Corner> cell;
  for (std::size_t k = 0; k < (lattice.dimension == 1 ? 2u : 4u); ++k)
    cell.push_back(in_body(lattice, frame, {corners[k][0] - about[0], corners[k][1] - about[1]}));
  return cell;
}

}  // namespace

std::vector<Corner> whole_cell(const Lattice& lattice) {
  return cell_from(lattice, frame_of(lattice), unshifted, {});
}

CellPolygons perturb_cells(const Lattice& lattice, std::vector<Site>& body) {
  if (lattice.cell_perturbation == 0.0) return {};
  const LatticeFrame frame = frame_of(lattice);
  const Corners corners(lattice, body);
  CellPolygons cells;
  for (Site& site : body) {
    const std::array<Corner, 4> of_cell = corners.of(site.cell);
    double area = 0.0;
    Corner centroid{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Corner &a = of_cell[k], &b = of_cell[(k + 1) % 4];
      const double twice = a[0] * b[1] - a[1] * b[0];
      area += 0.5 * twice;
      for (std::size_t c = 0; c < 2; ++c) centroid[c] += twice * (a[c] + b[c]) / 6.0;
    }
    for (double& along : centroid) along /= area;
    site.share = area;
    const Corner shift = in_body(lattice, frame, centroid);
    for (std::size_t c = 0; c < 2; ++c) site.place[c] += shift[c];
    cells.append(cell_from(lattice, frame, of_cell, centroid));
  }
  return cells;
}

}  // namespace peristat
