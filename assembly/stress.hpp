#pragma once

#include <vector>

#include "assembly/assembler.hpp"

namespace peristat {

/// Strain and stress of all points but images; on a part of a body of owned points. Tensors are
/// points x dimension x dimension, row major.
///
///   F      deformation gradient of the unbroken bonds, see deformation_gradients
///   E      = (F^T F - I) / 2, Green and Lagrange
///   P      = 1/V_i sum 1/n sum_a dE/dx_a (x) A_a, first Piola and Kirchhoff [Pa]: the virial of a
///            point's interactions, each of which is shared equally among its n points. Far from
///            surfaces and in a homogeneous state it is the derivative of the energy density by F;
///            near a surface or crack the interactions that are missing are missing in it, too
///   sigma  = P F^T / det F, Cauchy [Pa]; symmetric where the state is homogeneous within the
///            horizon. Von Mises and principal stresses are those of its symmetric part
///
/// For the linear solid of model lps F - I is the nonlocal displacement gradient, whose trace is
/// the dilatation; E = (F + F^T) / 2 - I, and sigma = P = lambda tr(E) I + 2 mu E.
///
/// A point whose F is not determined or, unless the solid is linear, has det F <= 0 gets F = I,
/// E = 0 and sigma = 0; P keeps its value.
struct Stress {
  std::vector<double> deformation_gradient, strain, first_piola, cauchy;
  std::vector<double> von_mises;            ///< per point [Pa]
  std::vector<double> principal;            ///< points x dimension, descending [Pa]
  std::vector<double> principal_direction;  ///< rows: unit vectors in the order of `principal`
  std::vector<char> is_determined;          ///< per point, whether F is determined
};

/// In-plane stresses that the out-of-plane stress is proportional to: those of Cauchy, or the
/// second Piola and Kirchhoff stresses S = F^-1 P, whose S_zz = J sigma_zz involves no strain
/// across the plane.
enum class AcrossPlane { cauchy_stress, second_stress };

/// @param out_of_plane 2D: stress across the plane over the sum of the normal stresses in it, nu in
///        plane strain and 0 in plane stress; one value for all points, or one per point
[[nodiscard]] Stress find_stress(Assembler& assembler, const StateView& at,
                                 const std::vector<double>& out_of_plane,
                                 AcrossPlane of = AcrossPlane::cauchy_stress);

}  // namespace peristat
