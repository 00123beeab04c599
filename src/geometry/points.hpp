#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "src/core/given_function.hpp"
#include "src/core/spacing.hpp"
#include "src/core/types.hpp"
#include "src/geometry/cell_polygons.hpp"
#include "src/geometry/images.hpp"
#include "src/geometry/mesh_elements.hpp"

namespace peristat {

class MeshInterior;
struct MeshBody;

/// Two neighbouring points, and the share of each other's volume that they count.
struct NeighbourShares {
  Index i = 0, j = 0;             ///< i < j
  double of_j = 1.0, of_i = 1.0;  ///< nu_ij, share of V_j that i counts, and nu_ji
};

/// Lattice that the points stand on: (position - origin) / spacing rounds to whole numbers, also in
/// a perturbed one.
struct LatticeCells {
  Coordinates origin{};               ///< a place of the lattice [m]
  std::vector<std::string> layers{};  ///< names of the sets of points outside the body
};

/// The body in its reference configuration: points that carry a volume, and named sets of them.
struct Points {
  int dimension = 0;              ///< 1, 2 or 3
  Spacing spacing = 0.0;          ///< lattice spacing, or mean spacing of a cloud [m]
  double angle = 0.0;             ///< of the lattice's axes to x, y about z [degrees]
  double cell_volume = 0.0;       ///< of a whole cell [m3]; 0: the points' mean volume
  std::vector<double> reference;  ///< positions, count x dimension, row major [m]
  std::vector<double> volume;     ///< per point [m3]
  /// Given neighbours, ascending by i and then j; empty: neighbours are those within the horizon.
  std::vector<NeighbourShares> neighbours{};
  std::map<std::string, std::vector<Index>> sets;  ///< ascending point numbers by set name
  std::optional<LatticeCells> lattice{};           ///< nothing for a cloud
  /// Cells of the points, without images; empty if cells are a lattice's, or cut by the body's
  /// boundary, or if there are none.
  CellPolygons polygons{};
  MeshElements elements{};  ///< of points at the centroids of a mesh's elements; or empty
  /// Mesh that the points were made of; null: they were made otherwise.
  std::shared_ptr<const MeshBody> mesh{};
  /// Inside of the mesh, which bonds must not leave; null: they may cross anything.
  std::shared_ptr<const MeshInterior> interior{};
  /// Number of each point's element or node in the mesh's file, or of the point among those that a
  /// program gives, from 0; empty if they come from elsewhere.
  std::vector<std::int32_t> source_row{};

  /// Further columns of the points' file by name: a value per point, in SI units.
  std::map<std::string, std::vector<double>> columns{};
  /// Functions that expressions at the points may call; null: none.
  std::shared_ptr<const GivenFunctions> functions{};
  /// Horizon of each point [m], see points.horizon of case files; images have that of their
  /// sources. Empty: one horizon for all.
  std::vector<double> horizons{};

  /// Places around the body that hold no point and that quadratures by collocation use, all x
  /// dimension [m].
  std::vector<double> ghosts{};

  Images images{};  ///< the last points; sets hold none of them

  /// For a part of a body that ranks share: number of its points, the first ones, that this rank
  /// owns. The others are ghosts, and sets may have no point here. Images come last, those of owned
  /// points first. Nothing: the body is whole.
  std::optional<Index> owned{};

  [[nodiscard]] Index count() const { return static_cast<Index>(volume.size()); }
  /// Number of points that are no images: the first ones.
  [[nodiscard]] Index own() const { return count() - static_cast<Index>(images.source.size()); }
  /// Number of points before ghosts and images.
  [[nodiscard]] Index own_rows() const { return owned.value_or(own()); }
  [[nodiscard]] bool is_image(Index point) const { return point >= own(); }
  /// Source of an image; any other point is its own source.
  [[nodiscard]] Index source(Index point) const {
    return is_image(point) ? images.source[std::size_t(point - own())] : point;
  }
  /// True if this rank owns a point, or the source of an image.
  [[nodiscard]] bool owns(Index point) const { return !owned || source(point) < *owned; }
  [[nodiscard]] const ImageKind& image_kind(Index image) const {
    return images.kinds[images.kind[std::size_t(image - own())]];
  }

  /// 1D: area [m2]; 2D: thickness [m]; 3D: 1, from volumes and spacing.
  [[nodiscard]] double cross_section() const {
    double cell = cell_volume;
    if (cell == 0.0) {
      for (const double of_point : volume) cell += of_point;
      cell /= double(count());
    }
    return cell / std::pow(spacing, dimension);
  }

  /// Reference position of a point, padded with zeros to three components.
  [[nodiscard]] Coordinates position(Index point) const {
    Coordinates at{};
    for (int c = 0; c < dimension; ++c) at[c] = reference[std::size_t(point) * dimension + c];
    return at;
  }
};

}  // namespace peristat
