#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "assembly/energy/history.hpp"
#include "assembly/terms/contact/contact_pairs.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/facet_approach.hpp"
#include "src/geometry/point_surface.hpp"

namespace peristat {

/// A segment, a triangle, a side or a corner of these, with its sign in the sum over the facets
/// that a point is near.
struct FacingPart {
  FacetCorners corner{-1, -1, -1};
  int corners = 0;
  double coefficient = 1.0;
};

/// A point with the facets that it may touch by one rule.
struct FacingPoint {
  Index point = 0;
  std::int32_t rule = 0;
  double distance = 0.0;            ///< d [m]
  double stiffness = 0.0;           ///< k [N/m]
  std::size_t first = 0, last = 0;  ///< of its parts
};

/// Points that face facets, ascending by rule and point.
struct FacingPoints {
  std::vector<FacingPoint> points{};
  std::vector<FacingPart> parts{};
  [[nodiscard]] std::span<const FacingPart> parts_of(const FacingPoint& of) const {
    return std::span(parts).subspan(of.first, of.last - of.first);
  }
};

/// The surface of a body whose points touch facets of it, for rules with faces. A point touches a
/// facet if the rule holds for it and each corner, and no bond has ever joined it to a corner.
///
/// The contact of a point with a surface is the sum over its parts, each with one less the
/// coefficients of the parts that it belongs to: in 2D segments less the corners that two share, in
/// 3D triangles less shared sides plus inner corners. Wherever the surface is nearest, the
/// coefficients at this place add up to 1, so that points slide over flat faces without bumps.
/// [Li et al. 2023, convergent incremental potential contact]
class ContactFaces {
 public:
  /// The arguments outlive it.
  ContactFaces(const ContactPairs& pairs, const Bonds& bonds);

  [[nodiscard]] bool none() const { return facets_.empty(); }
  [[nodiscard]] std::size_t facets() const { return facets_.size(); }
  [[nodiscard]] double bytes() const;

  /// Facets that a history leaves whole.
  [[nodiscard]] std::vector<char> whole(const History& history) const;
  /// Facets that have torn: those that had already, and those with a side whose bond has lost more
  /// than half of its integrity.
  [[nodiscard]] std::vector<Index> torn(const Model& model, const History& history) const;

  /// Share of the contact of two points that no bond has joined that is left to the pair: a half
  /// for each of them that does not touch a whole facet of the other.
  [[nodiscard]] double left_to_pair(const ContactPair& pair, std::span<const char> whole) const;

  /// Points within d + skin of whole facets, with these.
  /// @param displacement finite
  [[nodiscard]] FacingPoints near(std::span<const double> displacement, std::span<const char> whole,
                                  int threads) const;

  /// A point and a facet that may touch.
  struct Meeting {
    Index point = 0;
    std::int32_t rule = 0;
    double distance = 0.0;  ///< d [m]
    FacetCorners corner{};
  };
  /// Those that may come within d of one another while points move by a step.
  [[nodiscard]] std::vector<Meeting> on_way(std::span<const double> displacement,
                                            std::span<const double> step,
                                            std::span<const char> whole) const;

  /// Corners of a part as a point sees them.
  [[nodiscard]] FacetArms arms(Index point, const FacetCorners& corner, int corners,
                               std::span<const double> displacement) const;
  /// Corners of a facet: 2 or 3.
  [[nodiscard]] int corners() const { return pairs_.points().dimension; }

 private:
  struct Facet {
    FacetCorners corner;
    std::array<Offset, 3> bond;  // of the sides
  };
  /// A surface point by a rule.
  struct Facing {
    Index point;
    double distance, stiffness;
  };

  void find_facets();
  void find_facing();
  [[nodiscard]] std::vector<Facing> facing_by(const PairContactRule& rule) const;
  [[nodiscard]] bool touches(Index point, const Facet& facet, std::size_t rule) const;
  template <int D>
  [[nodiscard]] FacingPoints near_in(std::span<const double> displacement,
                                     std::span<const char> whole, int threads) const;
  void add_parts(std::span<const std::size_t> of_facets, FacingPoints& to) const;
  [[nodiscard]] std::span<const std::size_t> at_corner(Index point) const;

  const ContactPairs& pairs_;
  const Bonds& bonds_;
  std::vector<Facet> facets_;
  std::vector<Index> surface_;                    // points of facets, ascending
  std::vector<std::size_t> first_at_, facet_at_;  // facets of each of these
  std::vector<std::vector<Facing>> facing_;       // per rule, ascending by point
};

}  // namespace peristat
