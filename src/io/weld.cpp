// Merging of vertices at equal positions by a hash table of the coordinates' bits.
#include <bit>
#include <vector>

#include "io/mesh_file.h"

namespace prcage {
namespace {

using Position = std::array<double, 3>;
using Key = std::array<std::uint64_t, 3>;

// Equal keys are equal positions: +0 and -0 agree, a NaN equals itself.
Key key_of(const Position& p) {
  const auto bits = [](double x) { return x == 0 ? 0 : std::bit_cast<std::uint64_t>(x); };
  return {bits(p[0]), bits(p[1]), bits(p[2])};
}

// Mesh coordinates differ in their upper bits and are often zero in the lower ones: every step mixes the whole word.
std::uint64_t hash_of(const Key& key) {
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (const std::uint64_t word : key) {
    h = (h ^ word) * 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  h *= 0xc4ceb9fe1a85ec53u;
  return h ^ (h >> 29);
}

// Finds the vertex kept for a position; open addressing with linear probing, at most half full.
class PositionTable {
 public:
  explicit PositionTable(std::size_t vertices) : slots_(std::bit_ceil(2 * vertices + 1), empty) {}

  // The number of the kept vertex at p, or `next`, which then is remembered as the one kept at p.
  std::uint32_t find_or_insert(const Position& p, std::uint32_t next, const std::vector<Position>& kept) {
    const Key key = key_of(p);
    std::size_t slot = hash_of(key) & (slots_.size() - 1);
    while (slots_[slot] != empty) {
      if (key_of(kept[slots_[slot]]) == key) return slots_[slot];
      slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = next;
    return next;
  }

 private:
  static constexpr std::uint32_t empty = 0xffffffffu;
  std::vector<std::uint32_t> slots_;
};

}  // namespace

std::size_t weld_equal_positions(Mesh& mesh) {
  std::vector<Position>& positions = mesh.positions;
  const std::size_t before = positions.size();
  std::vector<std::uint32_t> new_index(before);
  PositionTable table(before);

  // The kept vertices move to the front of the array itself: the n-th kept one is never behind the one looked at.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < before; ++i) {
    new_index[i] = table.find_or_insert(positions[i], static_cast<std::uint32_t>(kept), positions);
    if (new_index[i] == kept) positions[kept++] = positions[i];
  }
  positions.resize(kept);

  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      if (corner < before) corner = new_index[corner];
    }
  }
  return before - kept;
}

}  // namespace prcage
