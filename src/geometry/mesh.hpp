#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace peristat {

/// A mesh as its file has it: nothing has been checked. Elements and nodes are numbered from 0 in
/// the order of the file, elements of all dimensions together.
struct Mesh {
  /// Elements of one type in a row.
  struct Block {
    std::string type{};                 ///< "triangle", "tetra10", …, as meshio calls it
    std::size_t nodes_per_element = 0;  ///< corners first, then those of higher order
    std::vector<std::int64_t> nodes{};  ///< elements x nodes_per_element
  };
  /// A named set of nodes or elements.
  struct Group {
    std::string name{};
    bool is_of_nodes = false;
    std::vector<std::int64_t> members{};
  };

  std::vector<double> nodes{};  ///< positions, count x 3 [m]
  std::vector<Block> blocks{};
  std::vector<Group> groups{};
  std::vector<std::string> remarks{};  ///< about what the file has and is not read
};

}  // namespace peristat
