#include "src/geometry/collared_body.hpp"

#include <utility>

namespace peristat {

CollaredBody::CollaredBody(const Solid& body, std::vector<Cover> covers, double spacing)
    : body_(body), covers_(std::move(covers)), spacing_(spacing) {
  for (const Cover& cover : covers_) {
    fronts_.emplace_back(body_, cover.side, cover.face, cover.depth, spacing,
                         std::vector<const FrontOfFace*>{});
  }
}

bool CollaredBody::contains(const Coordinates& place) const {
  if (body_.contains(place)) return true;
  std::size_t cover = 0;
  for (const FrontOfFace& front : fronts_) {
    const auto& where = covers_[cover++].where;
    if (front.contains(place) && (!where || where(place))) return true;
  }
  return false;
}

void CollaredBody::append_crossings(const Line& line, std::vector<double>& t) const {
  body_.append_crossings(line, t);
  for (const FrontOfFace& front : fronts_) front.append_crossings(line, t);
}

}  // namespace peristat
