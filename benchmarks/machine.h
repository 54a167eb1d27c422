#pragma once

#include <string>

namespace rgbd_pose {

// This machine, its name as given, and what the benchmarks were built with, as
// rows "| what | value |" of a table.
std::string DescribeMachine(const std::string& name);

// The instruction set that sums over matches use here.
std::string InstructionSetName();

}  // namespace rgbd_pose
