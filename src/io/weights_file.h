// Files of the weights that bind a mesh to a cage.
//
// All numbers are little-endian, nothing is padded. V vertices of the input with K weights each, T triangles of the
// input, and a cage of C vertices:
//
//   offset  bytes     what
//   0       8         the letters PRCAGE-W
//   8       4         version of the format, 1
//   12      4         B, bytes of a weight: 8 (double) or 4 (float)
//   16      8         V
//   24      8         T
//   32      8         C
//   40      8         faces of the cage
//   48      8         K, at least 1, at most C
//   56      4 x 8     doubles: largest and mean loss, largest and mean rest error (CageWeights)
//   88      12 T      triangles: three vertices each, below V
//   ...     4 V K     columns, only if K < C: the K vertices of the cage that each vertex has weights of, ascending
//   ...     B V K     weights
//   ...     8         XXH3-64 of all bytes before
//
// The positions of neither mesh are in the file: deform() needs only those of the deformed cage.
#pragma once

#include <string>

#include "core/prcage.h"
#include "io/mesh_file.h"

namespace prcage {

struct WeightsFile {
  bool ok = false;
  std::string error;  // if not ok: file, byte offset and element, what is wrong and what to do; one line
  CageWeights weights;
};

// "-" reads standard input. A file is believed only as far as it is long enough for what its header announces: a
// damaged one allocates no more than a small multiple of its size.
WeightsFile read_weights(const std::string& path);

// Under the same guarantee as write_mesh(). Weights that bind() did not make, or that were changed, are the caller's
// responsibility; they may be refused when they are read.
WriteResult write_weights(const std::string& path, const CageWeights& weights);

}  // namespace prcage
