#include "assembly/convolutions/forces_with_images.hpp"

#include <algorithm>
#include <utility>

namespace peristat {

ForcesWithImages::ForcesWithImages(std::unique_ptr<LatticeForces> of_all,
                                   std::unique_ptr<LatticeForces> of_images, std::size_t points,
                                   std::size_t own)
    : of_all_(std::move(of_all)), of_images_(std::move(of_images)), own_(own) {
  set_integrity(std::vector<double>(points, 1.0));
}

template <class Find>
void ForcesWithImages::take_off(std::span<double> from, const Find& find) {
  of_images_found_.assign(from.size(), 0.0);
  find(std::span<double>(of_images_found_));
  for (std::size_t k = 0; k < from.size(); ++k) from[k] -= 0.25 * of_images_found_[k];
}

void ForcesWithImages::set_integrity(std::span<const double> integrity) {
  integrity_.assign(integrity.begin(), integrity.end());
  for (std::size_t i = own_; i < integrity_.size(); ++i) integrity_[i] *= 0.5;
  of_all_->set_integrity(integrity_);
  integrity_.assign(integrity.begin(), integrity.end());
  std::fill_n(integrity_.begin(), own_, 0.0);
  of_images_->set_integrity(integrity_);
}

void ForcesWithImages::find_forces(std::span<const double> displacement, std::span<double> force) {
  of_all_->find_forces(displacement, force);
  take_off(force, [&](std::span<double> found) { of_images_->find_forces(displacement, found); });
}

void ForcesWithImages::find_forces_and_energies(std::span<const double> displacement,
                                                std::span<double> force, std::span<double> energy) {
  of_all_->find_forces_and_energies(displacement, force, energy);
  std::vector<double> of_images(energy.size());
  take_off(force, [&](std::span<double> found) {
    of_images_->find_forces_and_energies(displacement, found, of_images);
  });
  for (std::size_t i = 0; i < energy.size(); ++i) energy[i] -= 0.25 * of_images[i];
}

void ForcesWithImages::multiply(std::span<const double> displacement, std::span<const double> v,
                                std::span<double> product) {
  of_all_->multiply(displacement, v, product);
  take_off(product, [&](std::span<double> found) { of_images_->multiply(displacement, v, found); });
}

void ForcesWithImages::outline_tangent(std::span<const double> displacement,
                                       std::span<double> diagonal, std::span<double> row_sums) {
  of_all_->outline_tangent(displacement, diagonal, row_sums);
  take_off(diagonal, [&](std::span<double> found) {
    std::vector<double> unused(row_sums.size());
    of_images_->outline_tangent(displacement, found, unused);
  });
}

void ForcesWithImages::add_virials(std::span<const double> displacement,
                                   std::span<double> virials) {
  of_all_->add_virials(displacement, virials);
  take_off(virials, [&](std::span<double> found) { of_images_->add_virials(displacement, found); });
}

}  // namespace peristat
