#include "assembly/terms/contact/contact_faces.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "assembly/terms/contact/bond_shares.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/neighbourhood/cell_list.hpp"

namespace peristat {
namespace {

/// Points of a rule that are searched together, whatever the number of threads.
constexpr std::size_t points_per_part = 512;

/// Share of its integrity that a bond must have lost for the facets beside it to be gone.
constexpr double torn_share = 0.5;

/// Box of a set of points and of their ways.
struct WayBox {
  Coordinates lower{}, upper{};
  [[nodiscard]] bool meets(const WayBox& other, double reach) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if (lower[c] - reach > other.upper[c] || upper[c] + reach < other.lower[c]) return false;
    }
    return true;
  }
};

}  // namespace

ContactFaces::ContactFaces(const ContactPairs& pairs, const Bonds& bonds)
    : pairs_(pairs), bonds_(bonds), facing_(pairs.rules().size()) {
  const bool any = std::ranges::any_of(pairs.rules(), &PairContactRule::has_faces);
  if (!any) return;
  find_facets();
  find_facing();
}

double ContactFaces::bytes() const {
  std::size_t bytes = facets_.size() * sizeof(Facet) + surface_.size() * sizeof(Index) +
                      (first_at_.size() + facet_at_.size()) * sizeof(std::size_t);
  for (const auto& of_rule : facing_) bytes += of_rule.size() * sizeof(Facing);
  return double(bytes);
}

void ContactFaces::find_facets() {
  const auto are_joined = [&](Index i, Index j) { return bonds_.find(i, j).has_value(); };
  for (const FacetCorners& corner :
       surface_of_points(pairs_.points(), pairs_.sizes(), are_joined)) {
    Facet facet{corner, {-1, -1, -1}};
    for (int k = 0, side = 0; k < corners(); ++k) {
      for (int l = 0; l < k; ++l) {
        facet.bond[std::size_t(side++)] =
            *bonds_.find(corner[std::size_t(k)], corner[std::size_t(l)]);
      }
      surface_.push_back(corner[std::size_t(k)]);
    }
    facets_.push_back(facet);
  }
  std::ranges::sort(surface_);
  surface_.erase(std::ranges::unique(surface_).begin(), surface_.end());
  std::vector<std::vector<std::size_t>> at(surface_.size());
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    for (int k = 0; k < corners(); ++k) {
      const auto found = std::ranges::lower_bound(surface_, facets_[f].corner[std::size_t(k)]);
      at[std::size_t(found - surface_.begin())].push_back(f);
    }
  }
  first_at_ = {0};
  for (const auto& of_point : at) {
    facet_at_.insert(facet_at_.end(), of_point.begin(), of_point.end());
    first_at_.push_back(facet_at_.size());
  }
}

std::vector<ContactFaces::Facing> ContactFaces::facing_by(const PairContactRule& rule) const {
  // Of two bodies, each point takes the mean modulus of the other surface.
  std::array<double, 3> sum{}, count{};
  const auto side_of = [&](Index i) {
    return rule.side.empty() ? std::size_t(1) : std::size_t(rule.side[std::size_t(i)]);
  };
  for (const Index i : surface_) {
    sum[side_of(i)] += pairs_.moduli()[std::size_t(i)];
    count[side_of(i)] += 1.0;
  }
  std::vector<Facing> facing;
  for (const Index i : surface_) {
    const std::size_t side = side_of(i);
    if (side == 0) continue;
    const double own = pairs_.moduli()[std::size_t(i)];
    const std::size_t opposite = 3 - side;
    if (rule.has_two_sides && count[opposite] == 0.0) continue;
    const double other = rule.has_two_sides ? sum[opposite] / count[opposite] : own;
    const double size = pairs_.sizes()[std::size_t(i)];
    const double distance = rule.distance > 0.0 ? rule.distance : size;
    // Both surfaces touch each other's facets, so each has a half.
    facing.push_back(
        {i, distance,
         rule.stiffness * own * other / (own + other) * pairs_.section(size) / distance});
  }
  return facing;
}

void ContactFaces::find_facing() {
  for (std::size_t r = 0; r < facing_.size(); ++r) {
    if (pairs_.rules()[r].has_faces) facing_[r] = facing_by(pairs_.rules()[r]);
  }
  // Rest is free of forces, with a hair for round-off.
  constexpr double almost = 1.0 - 1e-14;
  const std::vector<double> at_rest(pairs_.points().reference.size());
  const std::vector<char> whole(facets_.size(), 1);
  const FacingPoints near = this->near(at_rest, whole, 1);
  for (const FacingPoint& of : near.points) {
    auto& all = facing_[std::size_t(of.rule)];
    Facing& facing = *std::ranges::lower_bound(all, of.point, {}, &Facing::point);
    double least = facing.distance;
    for (const FacingPart& part : near.parts_of(of)) {
      if (part.corners < corners()) continue;
      const FacetArms arms = this->arms(of.point, part.corner, part.corners, at_rest);
      least = std::min(least, almost * facet_distance(arms));
    }
    facing.stiffness *= facing.distance / least;
    facing.distance = least;
  }
}

std::vector<char> ContactFaces::whole(const History& history) const {
  std::vector<char> whole(facets_.size(), 1);
  for (const Index facet : history.torn_facets()) whole[std::size_t(facet)] = 0;
  return whole;
}

std::vector<Index> ContactFaces::torn(const Model& model, const History& history) const {
  struct Side {
    Index facet;
    Offset bond;
  };
  std::vector<Side> sides;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    for (const Offset bond : facets_[f].bond) {
      if (bond >= 0) sides.push_back({Index(f), bond});
    }
  }
  std::vector<Index> torn(history.torn_facets().begin(), history.torn_facets().end());
  for_each_lost_share(model, history, sides, [&](const Side& side, double lost) {
    if (lost > torn_share) torn.push_back(side.facet);
  });
  std::ranges::sort(torn);
  torn.erase(std::ranges::unique(torn).begin(), torn.end());
  return torn;
}

bool ContactFaces::touches(Index point, const Facet& facet, std::size_t rule) const {
  for (int k = 0; k < corners(); ++k) {
    const Index corner = facet.corner[std::size_t(k)];
    if (corner == point || !pairs_.rules()[rule].holds_for(point, corner) ||
        bonds_.find(point, corner)) {
      return false;
    }
  }
  return true;
}

std::span<const std::size_t> ContactFaces::at_corner(Index point) const {
  const auto found = std::ranges::lower_bound(surface_, point);
  if (found == surface_.end() || *found != point) return {};
  const auto place = std::size_t(found - surface_.begin());
  return std::span(facet_at_).subspan(first_at_[place], first_at_[place + 1] - first_at_[place]);
}

double ContactFaces::left_to_pair(const ContactPair& pair, std::span<const char> whole) const {
  const auto rule = std::size_t(pair.rule);
  if (pair.bond >= 0 || !pairs_.rules()[rule].has_faces) return 1.0;
  const auto touches_at = [&](Index point, Index corner) {
    return !at_corner(point).empty() && std::ranges::any_of(at_corner(corner), [&](std::size_t f) {
      return whole[f] != 0 && touches(point, facets_[f], rule);
    });
  };
  return (touches_at(pair.i, pair.j) ? 0.0 : 0.5) + (touches_at(pair.j, pair.i) ? 0.0 : 0.5);
}

FacetArms ContactFaces::arms(Index point, const FacetCorners& corner, int corners,
                             std::span<const double> displacement) const {
  const Points& points = pairs_.points();
  const auto d = std::size_t(points.dimension);
  const std::size_t own = std::size_t(point) * d;
  FacetArms arms;
  arms.corners = corners;
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    const std::size_t other = std::size_t(corner[k]) * d;
    for (std::size_t c = 0; c < d; ++c) {
      arms.reference[k][c] = points.reference[other + c] - points.reference[own + c];
      arms.moved[k][c] = displacement[other + c] - displacement[own + c];
    }
  }
  return arms;
}

FacingPoints ContactFaces::near(std::span<const double> displacement, std::span<const char> whole,
                                int threads) const {
  if (none()) return {};
  return pairs_.points().dimension == 2 ? near_in<2>(displacement, whole, threads)
                                        : near_in<3>(displacement, whole, threads);
}

template <int D>
FacingPoints ContactFaces::near_in(std::span<const double> displacement,
                                   std::span<const char> whole, int threads) const {
  std::vector<double> place(pairs_.points().reference);
  for (std::size_t k = 0; k < place.size(); ++k) place[k] += displacement[k];
  double longest = 0.0;  // side of a facet
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    if (whole[f] == 0) continue;
    const FacetArms arms = this->arms(facets_[f].corner[0], facets_[f].corner, D, displacement);
    for (int k = 1; k < D; ++k) longest = std::max(longest, length(arms.present(k)));
    if (D == 3) longest = std::max(longest, length(minus(arms.present(1), arms.present(2))));
  }
  const double radius = pairs_.reach() + pairs_.skin() + longest;
  const CellList<D> cells(place, surface_, radius);
  FacingPoints all;
  for (std::size_t r = 0; r < facing_.size(); ++r) {
    const std::vector<Facing>& facing = facing_[r];
    const auto parts = (facing.size() + points_per_part - 1) / points_per_part;
    std::vector<FacingPoints> found(parts);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
    for (std::size_t part = 0; part < parts; ++part) {
      std::vector<std::size_t> mine;
      const std::size_t end = std::min(facing.size(), (part + 1) * points_per_part);
      for (std::size_t k = part * points_per_part; k < end; ++k) {
        const auto& [point, distance, stiffness] = facing[k];
        mine.clear();
        std::array<double, D> at;
        for (int c = 0; c < D; ++c) at[c] = place[std::size_t(point) * D + c];
        cells.for_each_run(at, radius, [&](Index begin, Index last) {
          for (Index slot = begin; slot < last; ++slot) {
            double squared = 0.0;
            for (int c = 0; c < D; ++c) {
              const double step = cells.position[slot][c] - at[c];
              squared += step * step;
            }
            if (squared > radius * radius) continue;
            const auto facets = at_corner(cells.point[slot]);
            mine.insert(mine.end(), facets.begin(), facets.end());
          }
        });
        std::ranges::sort(mine);
        mine.erase(std::ranges::unique(mine).begin(), mine.end());
        std::erase_if(mine, [&](std::size_t f) {
          return whole[f] == 0 || !touches(point, facets_[f], r) ||
                 !(facet_distance(arms(point, facets_[f].corner, D, displacement)) <=
                   distance + pairs_.skin());
        });
        if (mine.empty()) continue;
        FacingPoints& to = found[part];
        to.points.push_back({point, std::int32_t(r), distance, stiffness, to.parts.size(), 0});
        add_parts(mine, to);
        to.points.back().last = to.parts.size();
      }
    }
    for (const FacingPoints& of : found) {
      for (FacingPoint point : of.points) {
        point.first += all.parts.size();
        point.last += all.parts.size();
        all.points.push_back(point);
      }
      all.parts.insert(all.parts.end(), of.parts.begin(), of.parts.end());
    }
  }
  return all;
}

void ContactFaces::add_parts(std::span<const std::size_t> of_facets, FacingPoints& to) const {
  std::vector<FacingPart> sides, ends;
  const auto note = [](std::vector<FacingPart>& among, const FacingPart& part) {
    const auto same = std::ranges::find(among, part.corner, &FacingPart::corner);
    if (same == among.end()) {
      among.push_back({part.corner, part.corners, 1.0 - part.coefficient});
    } else {
      same->coefficient -= part.coefficient;
    }
  };
  const auto note_corners = [&](const FacingPart& of) {
    for (int k = 0; k < of.corners; ++k) {
      note(ends, {{of.corner[std::size_t(k)], -1, -1}, 1, of.coefficient});
    }
  };
  for (const std::size_t f : of_facets) {
    const FacingPart facet{facets_[f].corner, corners(), 1.0};
    to.parts.push_back(facet);
    note_corners(facet);
    for (std::size_t k = 0; corners() == 3 && k < 3; ++k) {
      for (std::size_t l = k + 1; l < 3; ++l) {
        note(sides, {{facet.corner[k], facet.corner[l], -1}, 2, 1.0});
      }
    }
  }
  for (const FacingPart& side : sides) note_corners(side);
  for (const auto* const parts : {&sides, &ends}) {
    for (const FacingPart& part : *parts) {
      if (part.coefficient != 0.0) to.parts.push_back(part);
    }
  }
}

std::vector<ContactFaces::Meeting> ContactFaces::on_way(std::span<const double> displacement,
                                                        std::span<const double> step,
                                                        std::span<const char> whole) const {
  const Points& points = pairs_.points();
  const auto d = std::size_t(points.dimension);
  const auto add_way = [&](WayBox& box, Index point) {
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(point) * d + c;
      const double from = points.reference[dof] + displacement[dof], to = from + step[dof];
      box.lower[c] = std::min({box.lower[c], from, to});
      box.upper[c] = std::max({box.upper[c], from, to});
    }
  };
  const auto way_of = [&](std::span<const Index> of) {
    WayBox box;
    for (std::size_t c = 0; c < d; ++c) box.lower[c] = infinity, box.upper[c] = -infinity;
    for (const Index point : of) add_way(box, point);
    return box;
  };
  std::vector<std::pair<WayBox, std::size_t>> ways;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    if (whole[f] == 0) continue;
    ways.emplace_back(way_of(std::span(facets_[f].corner).first(d)), f);
  }
  std::ranges::sort(ways, {}, [](const auto& way) { return way.first.lower[0]; });
  double widest = 0.0;
  for (const auto& [box, f] : ways) widest = std::max(widest, box.upper[0] - box.lower[0]);
  std::vector<Meeting> meetings;
  for (std::size_t r = 0; r < facing_.size(); ++r) {
    for (const Facing& of : facing_[r]) {
      const WayBox own = way_of(std::span(&of.point, 1));
      auto way = std::ranges::lower_bound(ways, own.lower[0] - of.distance - widest, {},
                                          [](const auto& box) { return box.first.lower[0]; });
      for (; way != ways.end() && way->first.lower[0] <= own.upper[0] + of.distance; ++way) {
        const Facet& facet = facets_[way->second];
        if (!own.meets(way->first, of.distance) || !touches(of.point, facet, r)) continue;
        meetings.push_back({of.point, std::int32_t(r), of.distance, facet.corner});
      }
    }
  }
  return meetings;
}

}  // namespace peristat
