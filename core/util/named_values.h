#pragma once

#include <string>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

// A row of a table that gives values names.
template <typename Value>
struct Named {
  const char* name;
  Value value;
};

template <typename Row, size_t N>
std::vector<std::string> NamesOf(const Row (&rows)[N]) {
  std::vector<std::string> names;
  for (const Row& row : rows) names.emplace_back(row.name);
  return names;
}

inline InputError UnknownName(const std::string& what, const std::string& name,
                              const std::vector<std::string>& names) {
  return InputError("unknown " + what + " '" + name + "'; there are " +
                    Join(names));
}

// The value of that name. Throws InputError listing the names there are.
template <typename Value, size_t N>
Value ValueOf(const Named<Value> (&rows)[N], const std::string& what,
              const std::string& name) {
  for (const Named<Value>& row : rows) {
    if (row.name == name) return row.value;
  }
  throw UnknownName(what, name, NamesOf(rows));
}

}  // namespace rgbd_pose
