// A model as the page of `prcage report` shows it in 3D: input and cage, small enough for a page, and how far the cage
// is from the input, all over it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "core/prcage.h"

namespace prcage {

struct PageModel {
  std::string error;  // why there is nothing to show; empty otherwise

  // What the arrays are: numbers of vertices and faces, the cube, the largest distance in the input's unit.
  nlohmann::ordered_json contents = nlohmann::ordered_json::object();

  // The arrays one after the other, little endian: positions of the input (16 bits per coordinate, in the cube of the
  // contents), its triangles (16 bits per index); if there is a cage the same of it, distances to
  // the input (16 bits, in parts of the largest) and the subdivision of each face that they belong to (8 bits).
  std::string bytes;
};

// No mesh on the page has more faces. An input of more is simplified, which the contents say; of a cage of more there
// is nothing, since what is left of it after a simplification may intersect the input.
inline constexpr std::size_t page_faces = 20000;

// Distances are measured to the whole input. An empty name of the cage: there is none.
PageModel page_model(const std::string& input_file, const std::string& cage_file);

// With each byte sequence filled up by zeros to whole groups, so that there is no padding.
std::string base64(std::string bytes);

}  // namespace prcage
