#include "solvers/ranks/part_energy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace peristat {
namespace {

std::unique_ptr<GhostExchange> exchange_of(const Part& part, const Communicator& ranks) {
  const auto first_ghost = part.number.begin() + std::ptrdiff_t(part.owned);
  return make_ghost_exchange(ranks, {part.number.begin(), first_ghost},
                             {first_ghost, part.number.end()}, part.points.dimension);
}

}  // namespace

PartEnergy::PartEnergy(const Part& part, const Model& model, const Communicator& ranks, int threads)
    : part_(part),
      ranks_(ranks),
      assembler_(part.points, model, threads),
      ghosts_(exchange_of(part, ranks)),
      of_points_(part.points.volume.size()) {
  // Triangles stand on bonds between ghosts, which parts leave out; histories have no ranks yet.
  const bool is_of_bonds = model.terms().size() == 1 && model.bond_term() == model.terms()[0];
  if (!is_of_bonds || model.has_history()) {
    throw std::logic_error("PartEnergy: only bonds without damage have ranks yet");
  }
}

Evaluation PartEnergy::of_all(const StateView& at, const Evaluation& mine) {
  assembler_.point_energies(at, of_points_);
  double energy = 0.0;
  for (Index i = 0; i < part_.owned; ++i) energy += of_points_[std::size_t(i)];
  Evaluation all;
  all.energy = ranks_.sum(energy);
  all.degenerate = ranks_.max(double(mine.degenerate)) > 0.0 || !std::isfinite(all.energy);
  return all;
}

Evaluation PartEnergy::energy(const StateView& at) { return of_all(at, assembler_.energy(at)); }

Evaluation PartEnergy::gradient(const StateView& at, std::span<double> gradient) {
  const Evaluation all = of_all(at, assembler_.gradient(at, gradient));
  const auto owned = std::size_t(part_.owned) * std::size_t(part_.points.dimension);
  std::fill(gradient.begin() + std::ptrdiff_t(owned), gradient.end(), 0.0);
  return all;
}

PartTangent::PartTangent(PartEnergy& energy)
    : TangentOperator(energy.assembler().pattern(), energy.part().points.dimension,
                      energy.assembler().threads()),
      energy_(energy),
      tangent_(energy.assembler()) {
  reference = energy.part().points.reference;
  factor_.resize(reference.size());
}

void PartTangent::linearise(Energy& energy, const StateView& at, double projection) {
  if (&energy != &energy_.assembler()) throw std::logic_error("PartTangent: of another energy");
  tangent_.linearise(energy, at, projection);
  diagonal = tangent_.diagonal;
}

void PartTangent::multiply(std::span<const double> v, std::span<double> result) const {
  std::copy(v.begin(), v.end(), factor_.begin());
  energy_.update_ghosts(factor_);
  tangent_.multiply(factor_, result);
}

std::vector<char> without_ghosts(const Part& part, std::vector<char> prescribed) {
  const auto d = std::size_t(part.points.dimension);
  prescribed.resize(part.points.volume.size() * d);
  std::fill(prescribed.begin() + std::ptrdiff_t(std::size_t(part.owned) * d), prescribed.end(),
            char(1));
  return prescribed;
}

}  // namespace peristat
