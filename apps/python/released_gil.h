#pragma once

#include <Python.h>

namespace rgbd_pose {

// Releases the GIL for the lifetime of this object. Unlike pybind11's own
// class, its destructor may throw: if Python is shutting down, a daemon thread
// that asks for the GIL is unwound, and a noexcept destructor would call
// std::terminate().
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
