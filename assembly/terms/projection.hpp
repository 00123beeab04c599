#pragma once

namespace peristat {

/// Moves a symmetric matrix (size x size, row major) by a share in [0, 1] towards its positive
/// semidefinite part: negative eigenvalues are multiplied by 1 - share. Sizes 4, 6 and 9, those of
/// the relative Hessians of triangles (2D, 3D) and tetrahedra.
void project_to_semidefinite(double* matrix, int size, double share);

}  // namespace peristat
