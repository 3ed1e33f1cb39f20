// Built-in shapes: closed test bodies of any size, from a few dozen faces to hundreds of millions.
//
// They make the demo, the tests and the measurements independent of files. Every shape is a legal input of the
// library at every size: closed, manifold at edges and vertices, outward oriented, free of self-intersections.
// This holds by construction (radial displacement, marching tetrahedra, parts without overlap), not by repair.
//
// A shape is a pure function of (name, target, seed): the same bits on every machine. So it uses nothing but
// correctly rounded operations (+ - * / sqrt): no sine of the C library and no distribution of the standard one.
// Time and memory are linear in the number of faces. The y axis points up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/prcage.h"

namespace prcage {

struct ShapeInfo {
  const char* name;
  const char* description;                        // one line
  std::size_t smallest;                           // faces; smaller targets are raised to this (gyroid: approximate)
  std::size_t components;                         // of the surface
  std::optional<long long> euler_characteristic;  // none: depends on the size and the seed
};

// All shapes, in the order in which they should be listed.
std::span<const ShapeInfo> shape_table();

// Makes a shape of about `target_faces` faces: within 2 percent from 20000 faces on, within 5 percent from 1000 faces
// on (gyroid: 20 percent), as close as its grid allows below. An empty mesh and a message if there is no shape of that
// name or the target exceeds 1e9 faces; `error` is left alone otherwise.
Mesh make_shape(const std::string& name, std::size_t target_faces, std::uint64_t seed, std::string& error);

}  // namespace prcage
