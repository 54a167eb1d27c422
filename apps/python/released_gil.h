#pragma once

#include <Python.h>

namespace rgbd_pose {

// Lets other threads of Python run as long as it lives. Unlike pybind11's own,
// its end may be that of the thread: where Python is already ending, a daemon
// thread that asks for the GIL is unwound, and a destructor that throws nothing
// would end in std::terminate().
class ReleasedGil {
 public:
  ReleasedGil() : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() noexcept(false) { PyEval_RestoreThread(state_); }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

}  // namespace rgbd_pose
