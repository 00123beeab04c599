#include "assembly/terms/linear/cut_forces.hpp"

#include <utility>

namespace peristat {

CutForces::CutForces(std::unique_ptr<LatticeForces> whole, const Points& points, const Bonds& cut,
                     double micromodulus, int threads)
    : whole_(std::move(whole)),
      workspace_(BlockPattern(cut), points.dimension, threads),
      cut_(points, cut, micromodulus, workspace_) {}

template <class Find>
void CutForces::take_off(std::span<double> from, const Find& find) {
  of_cut_.assign(from.size(), 0.0);
  find(std::span<double>(of_cut_));
  for (std::size_t k = 0; k < from.size(); ++k) from[k] -= of_cut_[k];
}

void CutForces::set_integrity(std::span<const double> integrity) {
  whole_->set_integrity(integrity);
  cut_.set_integrity(integrity);
}

void CutForces::find_forces(std::span<const double> displacement, std::span<double> force) {
  whole_->find_forces(displacement, force);
  take_off(force, [&](std::span<double> of_cut) { cut_.find_forces(displacement, of_cut); });
}

void CutForces::find_forces_and_energies(std::span<const double> displacement,
                                         std::span<double> force, std::span<double> energy) {
  whole_->find_forces_and_energies(displacement, force, energy);
  take_off(force, [&](std::span<double> of_cut) { cut_.find_forces(displacement, of_cut); });
  take_off(energy, [&](std::span<double> of_cut) { cut_.find_energies(displacement, of_cut); });
}

void CutForces::multiply(std::span<const double> displacement, std::span<const double> v,
                         std::span<double> product) {
  whole_->multiply(displacement, v, product);
  take_off(product, [&](std::span<double> of_cut) { cut_.multiply(displacement, v, of_cut); });
}

void CutForces::outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                                std::span<double> row_sums) {
  whole_->outline_tangent(displacement, diagonal, row_sums);
  take_off(diagonal, [&](std::span<double> of_cut) {
    std::vector<double> unused(row_sums.size());
    cut_.outline_tangent(displacement, of_cut, unused);
  });
}

void CutForces::add_virials(std::span<const double> displacement, std::span<double> virials) {
  whole_->add_virials(displacement, virials);
  take_off(virials, [&](std::span<double> of_cut) { cut_.add_virials(displacement, of_cut); });
}

}  // namespace peristat
