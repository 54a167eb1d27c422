#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/factor_problem.h"
#include "apps/python/pickling.h"
#include "apps/python/problem.h"
#include "apps/python/released_gil.h"
#include "core/factors/blocks.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {

static void EachField(PickledBytes* bytes, FactorSolverSummary& s) {
  (*bytes)(s.status, s.reason, s.initial_cost, s.final_cost, s.iterations,
           s.solve_ms);
}

namespace {

FactorSolverSummary Solve(const Problem& problem, int max_iterations) {
  if (max_iterations < 1) {
    throw InputError("max_iterations: must be at least 1");
  }
  FactorProblem copy = problem.Load();
  FactorSolverOptions options;
  options.max_iterations = max_iterations;
  bool is_interrupted = false;
  // Python handles signals in its main thread only.
  const py::module_ threading = py::module_::import("threading");
  if (threading.attr("current_thread")().is(threading.attr("main_thread")())) {
    // Other threads may hold the GIL for milliseconds, so it is not asked for
    // after each of many short iterations.
    using Clock = std::chrono::steady_clock;
    options.is_interrupted = [&, asked = Clock::now()]() mutable {
      if (Clock::now() - asked < std::chrono::milliseconds(100)) return false;
      asked = Clock::now();
      const py::gil_scoped_acquire gil;
      is_interrupted = PyErr_CheckSignals() != 0;
      return is_interrupted;
    };
  }
  FactorSolverSummary summary;
  {
    const ReleasedGil no_gil;
    summary = SolveFactors(options, &copy);
  }
  if (is_interrupted) throw py::error_already_set();  // KeyboardInterrupt
  if (summary.status != FactorSolverStatus::kFailed) problem.Store(copy);
  return summary;
}

py::array Covariance(const Problem& problem, const py::sequence& blocks) {
  std::vector<int> wanted;
  for (size_t i = 0; i < blocks.size(); ++i) {
    wanted.push_back(
        problem.IndexOf(blocks[i], "blocks[" + std::to_string(i) + "]"));
  }
  FactorProblem copy = problem.Load();
  RowMajorMatrix covariance;
  {
    const ReleasedGil no_gil;
    covariance = FactorCovariance(std::move(copy), wanted);
  }
  return ArrayFromMatrix(covariance);
}

std::string SummaryInWords(const FactorSolverSummary& self) {
  std::string text = std::string("SolverSummary(") + ToString(self.status);
  if (!self.reason.empty()) text += ": " + self.reason;
  return text + Format(", cost %.6g to %.6g in %d iterations)",
                       self.initial_cost, self.final_cost, self.iterations);
}

void BindSummary(py::module_* module) {
  using Summary = FactorSolverSummary;
  py::class_<Summary> summary(*module, "SolverSummary", "How a solve went.");
  const auto property = PropertiesOf(&summary);
  property("status", &Summary::status,
           "'ok', 'not_converged' (the cost still fell at the last iteration) "
           "or 'failed'\n(no step could be taken; the blocks are unchanged)");
  property("reason", &Summary::reason, "reason of the status; empty if ok");
  property(
      "ok", [](const Summary& self) { return self.ok(); },
      "whether the status is 'ok'");
  property("initial_cost", &Summary::initial_cost,
           "half the sum of the squared residuals, under their losses, at the "
           "start;\nnan if a factor cannot be evaluated there");
  property("final_cost", &Summary::final_cost, "the same at the end");
  property("iterations", &Summary::iterations, "steps that were tried");
  property("solve_ms", &Summary::solve_ms, "solver time, ms");
  summary.def("__repr__", &SummaryInWords).def(Pickled<Summary>());
}

void BindPoses(py::module_* module) {
  module->def(
      "pose_block",
      [](const py::object& world_from_body) {
        const PoseVector pose =
            PoseVectorOf(RigidFromArray(world_from_body, "world_from_body"));
        return py::array_t<double>(pose.size(), pose.data());
      },
      py::arg("world_from_body"), R"(
Returns a (4, 4) pose as a new block (7,): qx qy qz qw x y z, m. Trajectories
(N, 7) have another order: tx ty tz qx qy qz qw.)");
  module->def(
      "pose_matrix",
      [](const py::object& pose) {
        const NumberArray numbers(pose, "pose", {PoseBlock::kSize});
        const PoseVector x =
            PoseVector::NullaryExpr([&](int i) { return numbers(i); });
        if (!x.allFinite() || !(x.head<4>().norm() > 0.0)) {
          throw InputError(
              "pose: is not finite, or has a quaternion of length 0");
        }
        return ToPython(RigidOf(x));
      },
      py::arg("pose"),
      "Returns a block (7,), qx qy qz qw x y z, as a (4, 4) pose, m.");
}

}  // namespace

void BindProblem(py::module_* module) {
  BindSummary(module);
  BindPoses(module);
  py::class_<Problem>(*module, "Problem", R"(
Factors over blocks: arrays of the caller, which solve changes in place.

A block is a float64 array that is contiguous and writeable; rows of an array
(N, 7) are N poses. The problem keeps its arrays alive. Two views of the same
memory are the same block.)")
      .def(py::init<>())
      .def("add_residual_block", &Problem::Add, py::arg("factor"),
           py::arg("loss"), py::arg("blocks"), R"(
Adds a factor over blocks.

loss: name of an M-estimator, such as 'huber' or 'huber(1.5)' (see losses());
    None: least squares.
blocks: list of arrays, as the class of the factor lists them.

Raises InputError, and adds nothing, for arrays of another size, type or memory
layout, for read-only ones and for those that overlap other blocks.)")
      .def(
          "set_parameter_block_constant",
          [](Problem* self, const py::object& block) {
            self->SetConstant(block, true);
          },
          py::arg("block"), "Holds a block of the problem.")
      .def(
          "set_parameter_block_variable",
          [](Problem* self, const py::object& block) {
            self->SetConstant(block, false);
          },
          py::arg("block"), "Lets solve move a block of the problem again.")
      .def("covariance", &Covariance, py::arg("blocks"), R"(
Returns the joint covariance of blocks at their present numbers, in their order:
6 rows for a pose, of [omega p], omega (rad) about the axes of the body, p (m)
along those of the world; N rows for other blocks of N numbers. It is zero for
constant blocks, and correct if the sigmas of the factors are.

Raises InputError if the factors do not determine all blocks of the problem. The
GIL is released.)")
      .def("__repr__", &Problem::InWords);
  module->def("solve", &Solve, py::arg("problem"), py::kw_only(),
              py::arg("max_iterations") = 100, R"(
Moves the blocks of a problem to a minimum of its cost near them and returns a
SolverSummary.

The arrays are read at the start and written at the end, if any step could be
taken; quaternions then have length 1. 'ok' means that no small step lowers the
cost, also where factors or losses do not pull: compare final_cost with half the
number of residuals, which it hardly exceeds if sigmas are right. Raises
InputError for blocks that are not finite. The GIL is released; Ctrl-C ends it
and leaves the arrays as they were.)");
}

}  // namespace rgbd_pose
