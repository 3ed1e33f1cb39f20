// What the ladder measures, one function a contender: the library, the reference simplifier, and the program with its
// input and output. All but simplify_meshopt() use threads and so must run in a child process (child.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/prcage.h"
#include "perf/child.h"

namespace prcage::perf {

// Writes a built-in shape as binary PLY.
Json write_shape(const std::string& shape, std::size_t faces, std::uint64_t seed, const std::string& path);

// make_cage(): seconds of wall time, status, faces of the cage, seconds by stage, rounds. A failure other than a budget
// that tau does not allow is an exception.
Json cage_mesh(const Mesh& mesh, const Options& options);

// meshopt_simplify() to `target_faces`, without an error limit: seconds, faces reached. It is free to cut through the
// input and to self-intersect; what it shares with prcage is the task of collapsing edges by a quadric. One thread.
Json simplify_meshopt(const Mesh& mesh, std::size_t target_faces);

// The program `prcage cage` from file to file: seconds in total, of reading and of writing.
Json run_program(const std::string& program, const std::string& input, const std::string& scratch,
                 const Options& options);

}  // namespace prcage::perf
