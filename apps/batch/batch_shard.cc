#include "apps/batch/batch_shard.h"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

std::optional<int> ParseWhole(std::string_view text) {
  int value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) {
    return std::nullopt;
  }
  return value;
}

std::optional<int> FromEnvironment(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? std::nullopt : ParseWhole(text);
}

BatchShard ShardOfSlurmTask() {
  const std::optional<int> id = FromEnvironment("SLURM_ARRAY_TASK_ID");
  const std::optional<int> count = FromEnvironment("SLURM_ARRAY_TASK_COUNT");
  if (!id || !count) return {};
  const int first = FromEnvironment("SLURM_ARRAY_TASK_MIN").value_or(0);
  if (*id < first || *id - first >= *count) {
    throw InputError("task " + std::to_string(*id) + " of a Slurm array of " +
                     std::to_string(*count) + " from " + std::to_string(first) +
                     " names no shard; use an array without gaps, such as "
                     "0-9, or give --shard");
  }
  return {*id - first, *count};
}

}  // namespace

std::string BatchShard::Name() const {
  return std::to_string(index) + "-of-" + std::to_string(count);
}

BatchShard ParseShard(const std::string& text) {
  if (text.empty()) return ShardOfSlurmTask();
  const size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::string_view view = text;
    const std::optional<int> index = ParseWhole(view.substr(0, slash));
    const std::optional<int> count = ParseWhole(view.substr(slash + 1));
    if (index && count && *index < *count) return {*index, *count};
  }
  throw InputError("--shard=" + text +
                   ": must be i/n with i from 0 to n - 1, such as 0/4");
}

}  // namespace rgbd_pose
