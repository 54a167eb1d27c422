#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// Types in an order; what is made of each follows from such a list.
template <typename... Types>
struct TypeList {};

// The names of the types, in their order.
template <typename... Types>
std::vector<std::string> NamesOfTypes(TypeList<Types...>) {
  return {Types::kName...};
}

}  // namespace rgbd_pose
