#include "tools/batch_inputs.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>
#include <tuple>

#include "io/mesh_file.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace prcage {
namespace {

namespace fs = std::filesystem;

std::set<std::string> meshes_of_directory(const fs::path& directory, const fs::path& output) {
  std::set<std::string> meshes;
  for (auto entry = fs::recursive_directory_iterator(directory); entry != fs::recursive_directory_iterator(); ++entry) {
    std::error_code error;
    if (fs::equivalent(entry->path(), output, error)) {
      entry.disable_recursion_pending();
      continue;
    }
    MeshFormat format{};
    if (!mesh_format_of_path(entry->path(), format) || !entry->is_regular_file(error)) continue;
    meshes.insert(entry->path().lexically_relative(directory));
  }
  return meshes;
}

std::set<std::string> meshes_of_list(const fs::path& list) {
  std::ifstream file(list);
  if (!file) throw fs::filesystem_error("cannot open", list, std::error_code(errno, std::generic_category()));
  std::set<std::string> meshes;
  for (std::string line; std::getline(file, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty() && line[0] != '#') meshes.insert(fs::path(line).lexically_normal());
  }
  return meshes;
}

std::uint64_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

}  // namespace

std::vector<BatchInput> find_batch_inputs(const std::string& path, const std::string& output) {
  const bool is_directory = fs::is_directory(path);
  const fs::path root = is_directory ? fs::canonical(path) : fs::canonical(path).parent_path();
  std::vector<BatchInput> inputs;
  for (const std::string& mesh : is_directory ? meshes_of_directory(root, output) : meshes_of_list(path)) {
    const fs::path file = root / mesh;
    inputs.push_back({mesh, file, size_of(file)});
  }
  return inputs;
}

std::vector<BatchInput> shard_of(std::vector<BatchInput> inputs, Shard shard) {
  std::erase_if(inputs, [shard](const BatchInput& input) {
    return XXH3_64bits(input.mesh.data(), input.mesh.size()) % shard.count != shard.index - 1;
  });
  return inputs;
}

void order_by_size(std::vector<BatchInput>& inputs) {
  std::sort(inputs.begin(), inputs.end(), [](const BatchInput& a, const BatchInput& b) {
    return std::tie(b.bytes, a.mesh) < std::tie(a.bytes, b.mesh);
  });
}

std::string cage_name(const std::string& mesh) {
  fs::path name;
  for (const fs::path& step : fs::path(mesh)) {
    std::string text;
    for (const char c : step.string()) text += c == '%' ? "%25" : c == '/' ? "%2F" : std::string(1, c);
    name /= text == ".." ? "%2E%2E" : text;
  }
  return name.string() + ".cage";
}

}  // namespace prcage
