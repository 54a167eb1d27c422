#pragma once

#include <string>

namespace rgbd_pose {

// Describes this machine, under the given name, and the build of the benchmarks
// as table rows "| what | value |".
std::string DescribeMachine(const std::string& name);

// The instruction set that sums over matches use on this machine.
std::string InstructionSetName();

}  // namespace rgbd_pose
