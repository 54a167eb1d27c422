#pragma once

#include "costs/bidirectional_point.h"

namespace rgbd_pose {

template <typename... Types>
struct TypeList {};

// All residual types. One header and one entry here make a cost: its Jacobian
// test, its benchmark, its name for programs and its place in the assemblies
// follow from this list.
using ResidualTypes = TypeList<BidirectionalPoint>;

}  // namespace rgbd_pose
