#pragma once

#include <string>

#include "src/geometry/mesh_body.hpp"

namespace peristat {

/// Words for an element in messages: its number in the file from 1, its kind and place.
[[nodiscard]] std::string element_text(const MeshBody& body, std::size_t element);
/// The same for a node.
[[nodiscard]] std::string node_text(const MeshBody& body, Index node);

/// Finds the boundary of a body: the sides of exactly one element.
/// @throws InputError ("file") for elements that overlap, sides of more than two elements, and
///         sides of boundaries that touch or cross without common nodes
void find_mesh_boundary(MeshBody& body, const std::string& file);

}  // namespace peristat
