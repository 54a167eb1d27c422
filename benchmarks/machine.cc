#include "benchmarks/machine.h"

#include <ceres/version.h>

#include <Eigen/Core>
#include <ctime>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <thread>

#include "core/util/vector_lanes.h"

namespace rgbd_pose {
namespace {

// The value after `key` and the separator in a file with one pair per line;
// "unknown" if there is none.
std::string ValueIn(const std::string& path, const std::string& key,
                    char separator) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind(key, 0) != 0) continue;
    const size_t first =
        line.find_first_not_of(" \"", line.find(separator) + 1);
    if (first == std::string::npos) continue;
    return line.substr(first, line.find_last_not_of(" \"") - first + 1);
  }
  return "unknown";
}

bool IsVirtual() {
  return (" " + ValueIn("/proc/cpuinfo", "flags", ':') + " ")
             .find(" hypervisor ") != std::string::npos;
}

std::string Today() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text;
}

std::string EigenVersion() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." +
         std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

}  // namespace

std::string InstructionSetName() {
#if defined(__x86_64__)
  switch (packed::ChosenInstructionSet()) {
    case packed::InstructionSet::kAvx512:
      return "AVX-512";
    case packed::InstructionSet::kAvx2:
      return "AVX2";
    case packed::InstructionSet::kBaseline:
      break;
  }
#endif
  return "the baseline";
}

std::string DescribeMachine(const std::string& name) {
  const std::string rows[][2] = {
      {"machine", name + (IsVirtual() ? " (virtual)" : "")},
      {"processor", ValueIn("/proc/cpuinfo", "model name", ':') + ", " +
                        std::to_string(std::thread::hardware_concurrency()) +
                        " cores, " + ValueIn("/proc/cpuinfo", "cpu MHz", ':') +
                        " MHz; all timings use one core"},
      {"system", ValueIn("/etc/os-release", "PRETTY_NAME", '=')},
      {"compiler", std::string(RGBD_POSE_COMPILER)},
      {"libraries", "Ceres " CERES_VERSION_STRING ", Eigen " + EigenVersion() +
                        ", OpenCV " CV_VERSION},
      {"sums over matches",
       "vectorised with " + InstructionSetName() + ", chosen at run time"},
      {"date", Today()},
  };
  std::string text;
  for (const auto& [what, value] : rows) {
    text += "| " + what + " | " + value + " |\n";
  }
  return text;
}

}  // namespace rgbd_pose
