#include "solvers/formulations/materials/point_materials.hpp"

#include <algorithm>

#include "src/conditions/with_key.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/expression_at_points.hpp"

namespace peristat {
namespace {

std::string place_of(const Points& points, Index point) {
  return place_text(points.position(point), points.dimension) + " m";
}

const std::vector<Index>& members_of(const Points& points, const std::string& set,
                                     const std::string& key) {
  const auto found = points.sets.find(set);
  if (found == points.sets.end()) throw InputError(key, '"' + set + '"', "no set of this name");
  return found->second;
}

/// Factors of points by an expression; an image has that of its source.
/// @param applies whether the expression is for a point; for others the factor is 1
template <class Applies>
std::vector<double> given_factors(const Points& points, const std::string& text,
                                  const std::string& key, const Applies& applies) {
  // Values outside are hardly meant as factors, but as moduli or strengths.
  constexpr double least = 1e-6, most = 1e6;
  std::vector<double> factors(std::size_t(points.own()), 1.0);
  with_key(key, [&] {
    const Expression expression = expression_of(text, points);
    std::vector<Index> members;
    for (Index i = 0; i < points.own(); ++i) {
      if (applies(i)) members.push_back(i);
    }
    const std::vector<double> values = values_at(expression, points, members);
    for (std::size_t k = 0; k < members.size(); ++k) {
      const Index i = members[k];
      const double factor = values[k];
      if (!(factor >= least && factor <= most)) {
        throw InputError(
            "", '"' + text + '"',
            "is " + number_text(factor) + " at " + place_of(points, i) +
                "; a factor must be from 1e-6 to 1e6: it multiplies the modulus or strength");
      }
      factors[std::size_t(i)] = factor;
    }
  });
  return factors;
}

}  // namespace

PointMaterials::PointMaterials(const BodySpecification& from, const Points& points)
    : from_(&from), has_rest_(from.regions.empty() || from.material.has_constants()) {
  if (has_rest_) all_.push_back({&from.material, "material", rest_name});
  if (from.regions.empty()) return;
  constexpr std::uint8_t of_none = 255;
  static_assert(most_materials + 1 < of_none);
  of_point_.assign(points.volume.size(), has_rest_ ? 0 : of_none);
  for (std::size_t k = 0; k < from.regions.size(); ++k) {
    const std::string key = "regions[" + std::to_string(k) + "]";
    const auto& [set, material] = from.regions[k];
    const auto own = static_cast<std::uint8_t>(all_.size());
    for (const Index point : members_of(points, set, key + ".set")) {
      std::uint8_t& of = of_point_[std::size_t(point)];
      if (of != (has_rest_ ? 0 : of_none)) {
        throw InputError(key + ".set", '"' + set + '"',
                         "overlaps the region of \"" + all_[of].name + "\": the point at " +
                             place_of(points, point) + " is in both");
      }
      of = own;
    }
    all_.push_back({&material, key + ".material", set});
  }
  for (Index image = points.own(); image < points.count(); ++image) {
    of_point_[std::size_t(image)] = of_point_[std::size_t(points.source(image))];
  }
  const auto left = std::count(of_point_.begin(), of_point_.end(), of_none);
  if (left == 0) return;
  const auto first = std::find(of_point_.begin(), of_point_.end(), of_none) - of_point_.begin();
  // A part of a body does not know how many there are in all.
  const std::string how_many = points.owned ? "some points" : std::to_string(left) + " points";
  throw InputError("regions", "",
                   (left == 1 && !points.owned ? "1 point has no material, at "
                                               : how_many + " have no material, one of them at ") +
                       place_of(points, Index(first)) +
                       "; put them in a region, or give a [material] for points in no region");
}

std::vector<std::int32_t> PointMaterials::regions() const {
  std::vector<std::int32_t> numbers;
  for (const std::uint8_t of : of_point_) numbers.push_back(of - (has_rest_ ? 1 : 0));
  return numbers;
}

std::ptrdiff_t PointMaterials::interface_of(std::size_t a, std::size_t b) const {
  std::ptrdiff_t of_all = -1;
  for (std::size_t k = 0; k < from_->interfaces.size(); ++k) {
    const auto& [one, other] = from_->interfaces[k].between;
    if (from_->interfaces[k].is_of_all()) of_all = std::ptrdiff_t(k);
    if ((one == all_[a].name && other == all_[b].name) ||
        (one == all_[b].name && other == all_[a].name)) {
      return std::ptrdiff_t(k);
    }
  }
  return of_all;
}

const InterfaceSpecification& PointMaterials::between(std::size_t a, std::size_t b) const {
  static const InterfaceSpecification by_default;
  const std::ptrdiff_t k = interface_of(a, b);
  return k < 0 ? by_default : from_->interfaces[std::size_t(k)];
}

std::string PointMaterials::key_between(std::size_t a, std::size_t b) const {
  const std::ptrdiff_t k = interface_of(a, b);
  return k < 0 ? "interfaces" : "interfaces[" + std::to_string(k) + "]";
}

std::vector<double> PointMaterials::factors(const Points& points,
                                            ScatterSpecification::Quantity quantity,
                                            int threads) const {
  std::vector<double> factors;
  for (std::size_t m = 0; m < all_.size(); ++m) {
    for (std::size_t k = 0; k < all_[m].of->scatter.size(); ++k) {
      const ScatterSpecification& scatter = all_[m].of->scatter[k];
      if (scatter.of != quantity) continue;
      if (factors.empty()) factors.assign(points.volume.size(), 1.0);
      const std::string key = all_[m].key + ".scatter[" + std::to_string(k) + "].factor";
      const std::vector<double> values =
          scatter.factor.empty()
              ? values_at(points, scatter.field, threads)
              : given_factors(points, scatter.factor, key, [&](Index i) { return of(i) == m; });
      for (Index i = 0; i < points.count(); ++i) {
        if (of(i) == m) factors[std::size_t(i)] = values[std::size_t(points.source(i))];
      }
    }
  }
  return factors;
}

}  // namespace peristat
