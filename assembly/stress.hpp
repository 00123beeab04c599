#pragma once

#include <vector>

#include "assembly/assembler.hpp"

namespace peristat {

/// Strain and stress of the points that stand for themselves, and of a part of a body of those that
/// are owned; tensors are points x dimension x
/// dimension, row major.
///
///   F      deformation gradient of the unbroken bonds, see deformation_gradients
///   E      = (F^T F - I) / 2, Green and Lagrange
///   P      = 1/V_i sum 1/n sum_a dE/dx_a (x) A_a, first Piola and Kirchhoff [Pa]: the virial of
///   the
///            interactions of a point, which are shared equally among their n points. Far from
///            surfaces and in a homogeneous state it is the derivative of the energy density by F;
///            near a surface or crack the interactions that are missing are missing in it, too
///   sigma  = P F^T / det F, Cauchy [Pa]; symmetric where the state is homogeneous within the
///            horizon. What follows is of its symmetric part
///
/// Of the linear solid of model lps F - I is its nonlocal gradient of the displacements, whose
/// trace is the dilatation; E = (F + F^T) / 2 - I, and sigma = P = lambda tr(E) I + 2 mu E.
///
/// A point without such an F, or with det F <= 0, has F = I, E = 0 and sigma = 0; P is its own.
struct Stress {
  std::vector<double> deformation_gradient, strain, first_piola, cauchy;
  std::vector<double> von_mises;            ///< per point [Pa]
  std::vector<double> principal;            ///< points x dimension, descending [Pa]
  std::vector<double> principal_direction;  ///< rows: unit vectors in the order of `principal`
  std::vector<char> is_determined;          ///< per point, whether F is
};

/// What a stress across the plane is a share of the sum of: stresses in it of Cauchy, or the second
/// ones of Piola and Kirchhoff, S = F^-1 P, whose S_zz = J sigma_zz has no strain across the plane.
enum class AcrossPlane { cauchy_stress, second_stress };

/// @param out_of_plane 2D: stress across the plane over the sum of those in it, nu in plane strain
///        and 0 in plane stress; of all points alike, or of each
[[nodiscard]] Stress find_stress(Assembler& assembler, const StateView& at,
                                 const std::vector<double>& out_of_plane,
                                 AcrossPlane of = AcrossPlane::cauchy_stress);

}  // namespace peristat
