#include "assembly/tangent_operator.hpp"

namespace peristat {

TangentOperator::TangentOperator(const Pattern& of, int dimension_of_points, int threads)
    : pattern(of),
      dimension(dimension_of_points),
      ranges(partition_rows(of, threads)),
      diagonal(std::size_t(of.points()) * dimension * dimension),
      position(std::size_t(of.points()) * dimension) {}

}  // namespace peristat
