#include "cases/runner/results/checkpoint/state_numbering.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "solvers/ranks/heard_of_bonds.hpp"
#include "src/geometry/image_number.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {

StateNumbering::StateNumbering(const RecordedPoints& points, const RowGathering& gathering,
                               const Model& model, const std::vector<char>& prescribed)
    : points_(points),
      part_(gathering.part()),
      gathering_(gathering),
      bonds_(model.bonds()),
      rows_of_histories_(model.failure().parts() == FailingParts::points ? Rows::points
                                                                         : Rows::bonds),
      prescribed_(prescribed) {
  std::vector<std::int64_t> counts;
  for (Index point = 0; point < part_.owned(); ++point) {
    counts.push_back(std::int64_t(told_bonds(point).size()));
  }
  std::tie(first_bond_, whole_bonds_) = gathering_.counted_before(counts);
}

void StateNumbering::pin(const FragmentPins& pins) {
  pinned_ = pins.pinned;
  first_free_.reset();
}

void StateNumbering::number_free_dofs() {
  if (first_free_) return;
  const auto d = std::size_t(points_.dimension());
  is_free_.assign(std::size_t(part_.owned()) * d, 0);
  std::vector<std::int64_t> counts(std::size_t(part_.owned()), 0);
  for (std::size_t dof = 0; dof < is_free_.size(); ++dof) {
    is_free_[dof] = !prescribed_[dof] && (pinned_.empty() || !pinned_[dof]);
    counts[dof / d] += is_free_[dof];
  }
  free_here_ = std::count(is_free_.begin(), is_free_.end(), 1);
  std::tie(first_free_.emplace(), whole_free_) = gathering_.counted_before(counts);
}

StateNumbering::Extent StateNumbering::extent(Rows rows) const {
  const std::int64_t points = points_.points().count();
  switch (named(rows)) {
    case Rows::points:
      return {part_.whole(), points, 1};
    case Rows::dofs:
      return {part_.whole(), points, points_.dimension()};
    case Rows::recorded_dofs:
      return {part_.whole(), part_.owned(), points_.dimension()};
    case Rows::free_dofs:
      return {whole_free_, free_here_, 1};
    case Rows::bonds:
      return {whole_bonds_, bonds_.count(), 1};
    case Rows::histories:
    case Rows::list_of_points:
    case Rows::whole:
      break;
  }
  throw std::logic_error("an array of a path's state that no rank has a part of");
}

std::int64_t StateNumbering::whole_size(Rows rows, std::size_t here) {
  if (part_.ranks().max(double(here)) == 0.0) return 0;
  if (rows == Rows::free_dofs) number_free_dofs();
  const Extent of = extent(rows);
  const std::int64_t mine = std::int64_t(here) - of.here * of.width;
  if (mine < 0) throw std::logic_error("an array of a path's state is too short");
  const auto beyond = std::int64_t(part_.ranks().max(double(mine)));  // rank 0 may have more
  return of.whole * of.width + beyond;
}

std::optional<std::size_t> StateNumbering::size_here(Rows rows, std::int64_t whole) {
  if (whole == 0) return 0;
  if (rows == Rows::free_dofs) number_free_dofs();
  const Extent of = extent(rows);
  const std::int64_t beyond = whole - of.whole * of.width;
  // A checkpoint of one rank also has values of images, which parts of a body do not report.
  const auto handles = std::int64_t(prescribed_.size()) - of.here * of.width;
  constexpr std::int64_t most_beyond = 1 << 16;
  const bool is_known =
      rows == Rows::dofs ? beyond == 0 || beyond == handles : beyond <= most_beyond;
  if (beyond < 0 || !is_known) return std::nullopt;
  const bool has_beyond = rows != Rows::free_dofs || part_.ranks().rank() == 0;
  return std::size_t(of.here * of.width + (has_beyond ? beyond : 0));
}

std::vector<StateNumbering::Place> StateNumbering::places(Rows rows, std::size_t size_here) const {
  std::vector<Place> places;
  if (size_here == 0) return places;
  visit_rows(rows, [&](std::int64_t whole, std::size_t here) { places.push_back({whole, here}); });
  const Extent of = extent(rows);
  if (part_.ranks().rank() > 0) return places;
  for (auto here = std::size_t(of.here * of.width); here < size_here; ++here) {
    places.push_back({(of.whole - of.here) * of.width + std::int64_t(here), here});
  }
  return places;
}

void StateNumbering::visit_rows(Rows rows,
                                const std::function<void(std::int64_t, std::size_t)>& visit) const {
  if (named(rows) == Rows::bonds) return visit_bonds(visit);
  if (rows == Rows::free_dofs) {
    const auto d = std::size_t(points_.dimension());
    std::size_t here = 0;
    for (std::size_t point = 0; point < first_free_->size(); ++point) {
      std::int64_t whole = (*first_free_)[point];
      for (std::size_t dof = point * d; dof < (point + 1) * d; ++dof) {
        if (is_free_[dof]) visit(whole++, here++);
      }
    }
    return;
  }
  const auto width = std::size_t(extent(rows).width);
  for (std::size_t point = 0; point < std::size_t(part_.owned()); ++point) {
    for (std::size_t c = 0; c < width; ++c) {
      visit(std::int64_t(part_.number_of(Index(point))) * std::int64_t(width) + std::int64_t(c),
            point * width + c);
    }
  }
}

void StateNumbering::visit_bonds(
    const std::function<void(std::int64_t, std::size_t)>& visit) const {
  for (Index point = 0; point < part_.owned(); ++point) {
    std::int64_t whole = first_bond_[std::size_t(point)];
    for (const Offset bond : told_bonds(point)) visit(whole++, std::size_t(bond));
  }
}

std::vector<Offset> StateNumbering::told_bonds(Index point) const {
  std::vector<Offset> told;
  for (Offset bond = bonds_.offset[point]; bond < bonds_.offset[point + 1]; ++bond) {
    if (points_.tells(point, bonds_.partner(point, bond))) told.push_back(bond);
  }
  std::ranges::sort(told, {}, [&](Offset bond) {
    const Index other = bonds_.partner(point, bond);
    return std::pair(image_number(points_.points(), other), points_.number(other));
  });
  return told;
}

void StateNumbering::give_to_others(Rows rows, std::vector<double>& values) const {
  if (named(rows) == Rows::points) give_to_ghosts(values, 1);
  if (rows == Rows::histories && named(rows) == Rows::points) give_to_images(values);
  if (rows == Rows::dofs) give_to_ghosts(values, std::size_t(points_.dimension()));
  if (named(rows) == Rows::bonds) give_bonds(values);
  if (rows == Rows::free_dofs) return;
  const Extent of = extent(rows);
  const auto first = values.begin() + std::ptrdiff_t(of.here * of.width);
  const bool tells = part_.ranks().rank() == 0;
  const std::vector<double> mine(tells ? first : values.end(), values.end());
  const std::vector<double> beyond = concatenated(part_.ranks(), mine);
  std::copy(beyond.begin(), beyond.end(), first);
}

void StateNumbering::give_to_ghosts(std::vector<double>& values, std::size_t width) const {
  const auto d = std::size_t(points_.dimension());
  const auto points = std::size_t(points_.points().count());
  std::vector<double> exchanged(points * d);
  for (std::size_t i = 0; i < points * width; ++i) exchanged[i / width * d + i % width] = values[i];
  part_.update_ghosts(exchanged);
  for (std::size_t i = 0; i < points * width; ++i) values[i] = exchanged[i / width * d + i % width];
}

void StateNumbering::give_to_images(std::vector<double>& values) const {
  const Points& points = points_.points();
  for (Index image = points.own(); image < points.count(); ++image) {
    values[std::size_t(image)] = values[std::size_t(points.source(image))];
  }
}

void StateNumbering::give_bonds(std::vector<double>& values) const {
  const HeardOfBonds heard = heard_of_bonds(
      bonds_, points_.points(), part_.numbered(), part_.ranks(), BetweenImages::what_they_show, 1,
      [&](Offset bond, double* to) { *to = values[std::size_t(bond)]; });
  for (std::size_t k = 0; k < heard.bond.size(); ++k) {
    values[std::size_t(heard.bond[k])] = heard.values[k];
  }
}

std::vector<Index> StateNumbering::numbers_of_all(const std::vector<Index>& points) const {
  std::vector<double> mine;
  for (const Index point : points) {
    if (point < part_.owned()) mine.push_back(double(points_.number(point)));
  }
  std::vector<double> all = concatenated(part_.ranks(), mine);
  std::ranges::sort(all);
  return {all.begin(), all.end()};
}

std::vector<Index> StateNumbering::points_here(const std::vector<Index>& numbers) const {
  std::vector<Index> points;
  for (const Index number : numbers) {
    const std::optional<Index> point = part_.find(number);
    if (point && *point < part_.owned()) points.push_back(*point);
  }
  return points;
}

}  // namespace peristat
