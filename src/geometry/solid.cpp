#include "src/geometry/solid.hpp"

#include <algorithm>

#include "src/core/infinity.hpp"
#include "src/geometry/pixels.hpp"

namespace peristat {

Solid::Solid(int dimension, const std::vector<ShapeStep>& steps) : dimension_(dimension) {
  for (const ShapeStep& step : steps) steps_.push_back(&step);
}

bool Solid::contains(const Coordinates& place) const {
  bool inside = false;
  for (const ShapeStep* step : steps_) {
    const bool adds = step->action == ShapeStep::Action::add;
    if (inside != adds && peristat::contains(step->shape, place)) inside = adds;
  }
  return inside;
}

void Solid::append_crossings(const Line& line, std::vector<double>& t) const {
  for (const ShapeStep* step : steps_) {
    peristat::append_crossings(step->shape, dimension_, line, t);
  }
}

void Solid::append_levels(const Coordinates& direction, std::vector<double>& levels) const {
  for (const ShapeStep* step : steps_) {
    peristat::append_levels(step->shape, dimension_, direction, levels);
  }
}

bool Solid::append_planes(std::array<std::vector<double>, 3>& at) const {
  return std::all_of(steps_.begin(), steps_.end(), [&](const ShapeStep* step) {
    if (const auto* const image = std::get_if<PixelImage>(&step->shape)) {
      for (std::size_t c = 0; c < 2; ++c) {
        const std::vector<double> borders = borders_along(*image, c);
        at[c].insert(at[c].end(), borders.begin(), borders.end());
      }
      return true;
    }
    const Box* box = std::get_if<Box>(&step->shape);
    for (int c = 0; c < dimension_ && box != nullptr; ++c) {
      at[c].push_back(box->min[c]);
      at[c].push_back(box->max[c]);
    }
    return box != nullptr;
  });
}

bool Solid::may_end_near(const Coordinates& place, double distance) const {
  return std::any_of(steps_.begin(), steps_.end(), [&](const ShapeStep* step) {
    return distance_to_boundary(step->shape, dimension_, place) < distance;
  });
}

Solid Solid::near(const Coordinates& place, double distance) const {
  Solid result = *this;
  result.steps_.clear();
  for (const ShapeStep* step : steps_) {
    const bool is_cut = distance_to_boundary(step->shape, dimension_, place) < distance;
    if (!is_cut && !peristat::contains(step->shape, place)) continue;
    if (!is_cut) result.steps_.clear();  // it covers all: earlier steps have no effect
    result.steps_.push_back(step);
  }
  return result;
}

bool Solid::holds_hull_of(const std::vector<Coordinates>& places) const {
  if (steps_.size() != 1 || steps_.front()->action != ShapeStep::Action::add) return false;
  const Shape& shape = steps_.front()->shape;
  return is_convex(shape) &&
         std::all_of(places.begin(), places.end(),
                     [&](const Coordinates& place) { return peristat::contains(shape, place); });
}

Box Solid::bounds() const {
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const ShapeStep* step : steps_) {
    if (step->action != ShapeStep::Action::add) continue;
    const Box added = peristat::bounds(step->shape);
    for (int c = 0; c < 3; ++c) {
      box.min[c] = std::min(box.min[c], added.min[c]);
      box.max[c] = std::max(box.max[c], added.max[c]);
    }
  }
  return box;
}

}  // namespace peristat
