#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <map>
#include <string>
#include <vector>

#include "apps/python/factor_problem.h"

namespace rgbd_pose {

// Factors over arrays of the caller. Arrays are read and changed here, with the
// GIL; solvers work on copies of the numbers, without it.
class Problem {
 public:
  // Adds a factor over blocks. Throws InputError, and adds nothing, for wrong
  // arguments.
  void Add(const pybind11::object& factor, const pybind11::object& loss,
           const pybind11::sequence& blocks);

  // Throws InputError unless the block is in the problem.
  void SetConstant(const pybind11::object& block, bool is_constant) {
    problem_.blocks[IndexOf(block, "block")].is_constant = is_constant;
  }

  // The index of a block. Throws InputError unless it is in the problem.
  int IndexOf(const pybind11::object& block, const std::string& where) const;

  // A copy with the present numbers of the arrays; quaternions of length 1.
  // Throws InputError if a block cannot be read, or is not finite.
  FactorProblem Load() const;

  // Writes the numbers of blocks that are not constant: all, or, with an
  // InputError, none.
  void Store(const FactorProblem& solved) const;

  // What it consists of.
  std::string InWords() const;

 private:
  // The index of a block that is in the problem from now on.
  int Hold(const pybind11::object& object, const factors::BlockKind& kind,
           const std::string& where);
  void DropLast();

  // The numbers of a block. Users may have changed flags of the array, or even
  // its size, since it was added.
  double* Memory(size_t i) const;
  std::string NameOf(size_t i) const;

  FactorProblem problem_;                          // Load fills in the numbers
  std::vector<pybind11::array_t<double>> arrays_;  // of the blocks
  // Blocks by the address of their numbers: two views of the same memory, such
  // as poses[0] twice, are the same block.
  std::map<const double*, int> indices_;
};

}  // namespace rgbd_pose
