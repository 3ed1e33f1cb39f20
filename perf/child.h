// One measurement in one process of its own: its peak memory is that of nothing else, and no measurement finds caches,
// heaps or thread pools that another one left behind.
#pragma once

#include <functional>

#include <nlohmann/json.hpp>

namespace prcage::perf {

using Json = nlohmann::ordered_json;

// Forks, runs f in the child and returns what it returned, with its "peak_memory_bytes", also of programs that it ran
// and waited for, added. The caller's memory is shared with the child until one of them writes. Throws
// std::runtime_error if the child does not come to a good end. Processes with threads cannot fork safely: the caller
// must never have used TBB.
Json run_in_child(const std::function<Json()>& f);

}  // namespace prcage::perf
