#include "solvers/observe/separated_bonds.hpp"

#include <utility>

#include "assembly/terms/damage.hpp"

namespace peristat {

SeparatedBonds::SeparatedBonds(const Body& body)
    : body_(body), points_(body.points, *body.index_map) {
  for (const BondEnds& ends : body.cut_bonds) {
    if (points_.tells(ends[0], ends[1])) ends_.push_back(ends);
  }
  cut_ = ends_.size();
}

std::span<const BondEnds> SeparatedBonds::add_broken(const History& history) {
  const std::size_t before = ends_.size();
  std::vector<char> broken = broken_bonds(body_.model, history);
  if (broken.empty()) return {};
  broken_.resize(broken.size(), 0);
  const Bonds& bonds = body_.model.bonds();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken[bond] || broken_[bond] || bonds.weight(bond) == 0.0) continue;
      if (points_.tells(i, bonds.partner(i, bond))) ends_.push_back({i, bonds.partner(i, bond)});
    }
  }
  broken_ = std::move(broken);
  return std::span(ends_).subspan(before);
}

CrackState SeparatedBonds::cracks(const StepRecord& record, const CrackGrowth& before) const {
  return {ends_,
          cut_,
          record.external_work + record.numerical_work - record.stored_energy -
              (record.motion ? record.motion->kinetic_energy : 0.0),
          record.dissipated_energy,
          before,
          points_.ranks(),
          body_.setting.cross_section};
}

}  // namespace peristat
