// The thin layer over TBB that the stages use: ranges in chunks, and lists gathered from chunks in index order, so that
// no result depends on which thread did what. TBB's own headers, which take a second to compile, stay out of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace prcage {

inline constexpr std::size_t default_grain = 1024;

// call(body, begin, end) on disjoint chunks of [0, n).
using ChunkCall = void (*)(const void* body, std::size_t begin, std::size_t end);
void run_chunks(std::size_t n, std::size_t grain, const void* body, ChunkCall call);

// body(begin, end) on disjoint chunks of [0, n).
template <class Body>
void parallel_chunks(std::size_t n, std::size_t grain, const Body& body) {
  run_chunks(n, grain, &body,
             [](const void* any, std::size_t begin, std::size_t end) { (*static_cast<const Body*>(any))(begin, end); });
}

// body(i) for i in [0, n).
template <class Body>
void parallel_each(std::size_t n, std::size_t grain, const Body& body) {
  parallel_chunks(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

// Concatenates what body(begin, end, list) appends for fixed chunks of [0, n), in the order of the chunks.
template <class T, class Body>
std::vector<T> parallel_gather(std::size_t n, std::size_t chunk, const Body& body) {
  const std::size_t chunks = (n + chunk - 1) / chunk;
  std::vector<std::vector<T>> parts(chunks);
  parallel_each(chunks, 1, [&](std::size_t c) { body(c * chunk, std::min(n, (c + 1) * chunk), parts[c]); });
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace prcage
