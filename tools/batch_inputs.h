// Which meshes a batch is about: the files of a directory or of a list, and the part of them that is one shard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace prcage {

struct BatchInput {
  std::string mesh;         // names it in the table: the path relative to the directory, or as the list has it
  std::string file;         // absolute path
  std::uint64_t bytes = 0;  // 0 also if there is no such file: whoever reads it will say so
};

// Part `index` of `count`, from 1.
struct Shard {
  std::size_t index = 1;
  std::size_t count = 1;
};

// `path` is a directory, in which files named as meshes are looked for at any depth, `output` left out; or a text file
// with a path on each line, relative to the file's own directory, where empty lines and lines that begin with # mean
// nothing. Each mesh once, ordered by name. Throws std::filesystem::filesystem_error.
std::vector<BatchInput> find_batch_inputs(const std::string& path, const std::string& output);

// The inputs of one shard. Depends on their names alone, so that all shards agree, and go on agreeing when there are
// more meshes.
std::vector<BatchInput> shard_of(std::vector<BatchInput> inputs, Shard shard);

// The largest files first, so that the end of a batch is not the wait for one of them.
void order_by_size(std::vector<BatchInput>& inputs);

// Where the cage of a mesh goes, relative to the directory of cages, without the extension: different for different
// meshes, and within that directory whatever a list says.
std::string cage_name(const std::string& mesh);

}  // namespace prcage
