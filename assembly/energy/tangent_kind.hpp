#pragma once

namespace peristat {

/// What a tangent is made of. Each kind can be turned into the later ones, so that a sum has the
/// last kind of its terms.
enum class TangentKind {
  visited,   ///< blocks of a symmetric matrix, computed row by row: they need not be stored
  stored,    ///< blocks of a symmetric matrix, which have to be stored
  rows,      ///< sparse rows of an unsymmetric matrix
  products,  ///< products with vectors, without blocks or rows
};

}  // namespace peristat
