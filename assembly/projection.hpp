#pragma once

namespace peristat {

/// Replaces a symmetric matrix (size x size, row major) by its positive semidefinite part: negative
/// eigenvalues become zero. Sizes 4, 6 and 9, those of the relative Hessians of triangles (2D, 3D)
/// and tetrahedra.
void project_to_semidefinite(double* matrix, int size);

}  // namespace peristat
