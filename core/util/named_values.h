#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/input_error.h"

namespace rgbd_pose {

// A row of a table that assigns names to values.
template <typename Value>
struct Named {
  const char* name;
  Value value;
};

template <typename Rows>
std::vector<std::string> NamesOf(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

// The error for a name that is not in a table, with those that are.
InputError UnknownName(const std::string& what, const std::string& name,
                       const std::vector<std::string>& names);

// Returns the row with this name, or null if there is none.
template <typename Rows>
auto FindNamed(const Rows& rows, std::string_view name) {
  const auto row = std::find_if(std::begin(rows), std::end(rows),
                                [=](const auto& r) { return r.name == name; });
  return row == std::end(rows) ? nullptr : &*row;
}

// Returns the row with this name. Throws InputError with all known names.
template <typename Rows>
const auto& RowOf(const Rows& rows, const std::string& what,
                  std::string_view name) {
  if (const auto* row = FindNamed(rows, name)) return *row;
  throw UnknownName(what, std::string(name), NamesOf(rows));
}

}  // namespace rgbd_pose
