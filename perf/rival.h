// What the contenders of perf/compare have in common: each is a program `PROGRAM INPUT FACES OUTPUT` that makes a cage
// of about FACES faces, writes it, and prints what it did as one JSON object: `seconds` of the attempt that is kept,
// with files off the clock, `search_seconds` of all attempts together, `settings` that were found.
//
// What they have no option for they must find: how thick the offset has to be for the wanted number of faces. All find
// it on the same ladder, from thin to thick, and keep the first attempt of the best rank, as somebody would who checks
// results and wants the tightest one. One thread each.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/prcage.h"

namespace prcage::perf {

struct Attempt {
  Mesh cage;  // empty if nothing came of it
  double seconds = 0;
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
};

struct Search {
  Attempt kept;
  double seconds = 0;
};

// From l / 400 to l / 9, each 1.6 times the one before; relative to l.
std::vector<double> offset_ladder();

// The first attempt of the highest rank: all four of the paper's conditions, the first three, any mesh of few enough
// faces, any mesh. An attempt of the highest rank ends the search.
Search tightest_attempt(const Mesh& input, std::size_t faces, const std::function<Attempt(double offset)>& attempt);

// The program. `search` gets the input and the number of faces.
int rival_main(int argc, char** argv, const std::function<Search(const Mesh&, std::size_t)>& search);

}  // namespace prcage::perf
