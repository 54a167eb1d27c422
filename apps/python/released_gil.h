#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

namespace rgbd_pose {

// Releases the GIL for the lifetime of this object. Unlike pybind11's own
// class, it outlives the end of Python: a daemon thread that asks for the GIL
// after that is unwound, which would free Python objects without the GIL, or
// call std::terminate() in a noexcept destructor. Such a thread sleeps here
// until the process ends, as Python itself does it from 3.14 on.
class ReleasedGil {
 public:
  ReleasedGil() : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() {
    try {
      PyEval_RestoreThread(state_);
    } catch (abi::__forced_unwind&) {
      for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
    }
  }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

// Call this during long work without the GIL, so that Ctrl-C raises
// KeyboardInterrupt.
inline void ThrowIfInterrupted() {
  const pybind11::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

}  // namespace rgbd_pose
