#include "solvers/body/describe_body.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>

#include "assembly/terms/contact/pair_contact_term.hpp"
#include "assembly/terms/points/point_term.hpp"
#include "solvers/linear/available_memory.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/neighbourhood/share_on_horizon.hpp"

namespace peristat {

namespace {

/// Fraction of the bonds above which those on the horizon are a shell of a lattice.
constexpr double least_shell = 0.01;

/// Norm of a bond; with horizons of points the larger of its ratios to those that reach it, times
/// the setting's horizon.
double norm_in_setting(const Body& body, Index i, Index j) {
  const Points& points = body.points;
  const double norm = norm_between(points, i, j, body.setting.shape);
  if (points.horizons.empty()) return norm;
  double largest = 0.0;
  for (const Index end : {i, j}) {
    const double ratio = norm / points.horizons[std::size_t(end)];
    if (ratio <= inclusive_radius(1.0)) largest = std::max(largest, ratio);
  }
  return largest * body.setting.horizon;
}

}  // namespace

std::vector<std::string> describe_interactions(const Body& body) {
  std::vector<std::string> lines;
  for (const auto& term : body.model.terms()) {
    if (term->failure()) continue;  // reported separately
    for (const InteractionCount& kind : term->counts()) {
      const auto [least, most] = std::minmax_element(kind.per_point.begin(), kind.per_point.end());
      lines.push_back(
          fmt::format("{} {}; per point {} to {}", kind.count, kind.name, *least, *most));
    }
  }
  const auto* const points = body.model.find<PointTerm>();
  if (points != nullptr && points->has_lattice()) {
    lines.push_back(fmt::format("summed by convolutions over a box of {} sites",
                                points->lattice()->box.count()));
  }
  const InteractionStorage& storage = body.interaction_storage;
  if (storage.needed > 0.0) {
    lines.push_back(fmt::format("{}: storing them takes {}, and {} are free for it",
                                storage.fits() ? "stored" : "found anew in every pass",
                                bytes_text(storage.needed), bytes_text(storage.room)));
  }
  const bool is_by_length =
      body.setting.shape == HorizonShape::ball && body.points.horizons.empty();
  std::function<double(Index, Index)> norm;
  if (!is_by_length) norm = [&](Index i, Index j) { return norm_in_setting(body, i, j); };
  const double on_horizon = share_on_horizon(body.model.bonds(), body.setting, norm);
  if (on_horizon > least_shell) {
    lines.push_back(
        fmt::format("{:.2g} % of the bonds are exactly as long as the horizon, so round-off "
                    "decides which points are neighbours; take a ratio between two distances of "
                    "the lattice, such as 3.015, or a volume_correction",
                    100.0 * on_horizon));
  }
  return lines;
}

std::vector<std::string> describe_constraints(const Body& body) {
  std::vector<std::string> lines;
  for (const Foundations::Summary& of : body.conditions->foundations().summaries()) {
    lines.push_back(fmt::format("{}: {} springs, {} N/m in all", of.name, of.springs,
                                place_text(of.stiffness, body.points.dimension)));
  }
  for (const Obstacles::Obstacle& of : body.conditions->obstacles().all()) {
    constexpr std::array kinds{"plane", "cylinder", "sphere"};
    const std::string driven =
        of.free_axis ? fmt::format(", driven along {} by a force", "xyz"[*of.free_axis]) : "";
    lines.push_back(fmt::format("{}: a {} that {} points may touch{}", of.name,
                                kinds[std::size_t(of.surface.kind)], of.last - of.first, driven));
  }
  if (const auto* const contact = body.model.find<PairContactTerm>()) {
    const std::vector<ContactPair> near =
        contact->contacts().pairs.near(std::vector<double>(body.points.reference.size()), 1);
    const auto faces = std::ranges::count_if(near, [](const ContactPair& pair) {
      return pair.bond < 0 && pair.reference <= pair.distance * (1.0 + horizon_tolerance);
    });
    lines.push_back(fmt::format("contact: {} pairs of points face each other without a bond{}",
                                faces,
                                body.model.has_history() ? "; bonds that break add theirs" : ""));
    const ContactFaces& surface = contact->contacts().faces;
    if (!surface.none()) {
      lines.push_back(fmt::format("contact: {} {} join the points of the surface", surface.facets(),
                                  body.points.dimension == 2 ? "segments" : "triangles"));
    }
  }
  std::size_t rigid = 0;
  const auto& sets = body.conditions->constraints().rigid_sets();
  for (const Restraint& restraint : body.conditions->restraints()) {
    switch (restraint.kind) {
      case Restraint::Kind::rigid_set: {
        const Constraints::RigidSet& set = sets[rigid++];
        lines.push_back(fmt::format("{}: {} points move as one rigid body about {} m",
                                    restraint.name, set.members.size(),
                                    place_text(set.centre, body.points.dimension)));
        break;
      }
      case Restraint::Kind::rollers:
        lines.push_back(fmt::format("{}: held along {} only", restraint.name,
                                    place_text(restraint.direction, body.points.dimension)));
        break;
      case Restraint::Kind::linear:
        lines.push_back(fmt::format("{}: linear constraint", restraint.name));
        break;
      case Restraint::Kind::symmetry:
      case Restraint::Kind::period:
        lines.push_back(fmt::format("{}: {} image points within the horizon", restraint.name,
                                    body.points.count() - body.points.own()));
        break;
    }
  }
  return lines;
}

}  // namespace peristat
