#pragma once

// Vectors of doubles as compiler extensions (GCC, Clang), with the instruction
// set chosen at run time: AVX-512 or AVX2 if available.

namespace rgbd_pose {

constexpr int kMaxLanes = 8;

template <int W>
struct Lanes {
  static_assert(W <= kMaxLanes, "columns are padded to kMaxLanes");
  typedef double Type __attribute__((vector_size(W * sizeof(double))));
};

#if defined(__x86_64__)

namespace packed {

// flatten inlines all calls, so that no function shared with the rest of the
// program is compiled for the instruction set. With GCC's sanitizers this takes
// many minutes; there it is limited to the kernel itself.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RGBD_POSE_TARGET(set) [[gnu::target(set)]]
#else
#define RGBD_POSE_TARGET(set) [[gnu::target(set), gnu::flatten]]
#endif

template <typename Kernel, typename... Args>
RGBD_POSE_TARGET("avx512f,avx512dq,avx512vl,avx2,fma")
void RunAvx512(Args... args) {
  Kernel::template Run<8>(*args...);
}

template <typename Kernel, typename... Args>
RGBD_POSE_TARGET("avx2,fma")
void RunAvx2(Args... args) {
  Kernel::template Run<4>(*args...);
}

#undef RGBD_POSE_TARGET

enum class InstructionSet { kBaseline, kAvx2, kAvx512 };

// The instruction set kernels run with: the best one the machine has. A
// benchmark or a test may set a lower one while no kernel runs.
inline InstructionSet& ChosenInstructionSet() {
  static InstructionSet chosen = [] {
    if (__builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
      return InstructionSet::kAvx512;
    }
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
               ? InstructionSet::kAvx2
               : InstructionSet::kBaseline;
  }();
  return chosen;
}

}  // namespace packed

#endif

// Calls Kernel::Run<W>(args...) with the widest W the machine supports.
template <typename Kernel, typename... Args>
void RunVectorised(const Args&... args) {
#if defined(__x86_64__)
  switch (packed::ChosenInstructionSet()) {
    case packed::InstructionSet::kAvx512:
      return packed::RunAvx512<Kernel>(&args...);
    case packed::InstructionSet::kAvx2:
      return packed::RunAvx2<Kernel>(&args...);
    case packed::InstructionSet::kBaseline:
      break;
  }
#endif
  Kernel::template Run<2>(args...);
}

}  // namespace rgbd_pose
