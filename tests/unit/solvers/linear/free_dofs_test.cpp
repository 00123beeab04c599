#include "solvers/linear/free_dofs.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(FreeDofs, NumberWhatIsNotPrescribed) {
  const FreeDofs free({0, 1, 1, 0, 0, 1}, 2);
  EXPECT_EQ(free.count(), 3);
  EXPECT_EQ(free.dof, (std::vector<Index>{0, 3, 4}));
  EXPECT_EQ(free.equation,
            (std::vector<Index>{0, FreeDofs::none, FreeDofs::none, 1, 2, FreeDofs::none}));
}

TEST(FreeDofs, RestrictAndExtend) {
  const FreeDofs free({0, 1, 1, 0, 0, 1}, 2);
  std::vector<double> few(3), all(6, 9.0);
  free.restrict_to_free(std::vector<double>{1, 2, 3, 4, 5, 6}, few);
  EXPECT_EQ(few, (std::vector<double>{1, 4, 5}));
  free.extend_by_zero(few, all);
  EXPECT_EQ(all, (std::vector<double>{1, 0, 0, 4, 5, 0}));
}

}  // namespace
}  // namespace peristat
