#include "apps/python/problem.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "apps/python/any_factor.h"
#include "core/util/input_error.h"
#include "robust/m_estimator.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

std::string TypeName(const py::object& object) {
  return py::str(py::type::of(object).attr("__name__"));
}

// The array of a block. Throws InputError unless a solve can change it in
// place.
py::array_t<double> BlockArray(const py::object& object,
                               const std::string& where) {
  if (!py::isinstance<py::array>(object)) {
    throw InputError(
        where + ": is a " + TypeName(object) +
        "; a block is a numpy array, which solve changes in place");
  }
  const py::array array = py::reinterpret_borrow<py::array>(object);
  if (!py::isinstance<py::array_t<double>>(array)) {
    throw InputError(where + ": holds " + std::string(py::str(array.dtype())) +
                     "; a block holds float64, which solve changes in place");
  }
  constexpr int kPlain = py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ |
                         py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  if ((array.flags() & kPlain) != kPlain) {
    throw InputError(where +
                     ": is not contiguous; solve changes blocks in "
                     "place, so make an array of its own for it");
  }
  if (!array.writeable()) {
    throw InputError(where +
                     ": is read-only; solve changes blocks in place, "
                     "so pass a copy");
  }
  return py::reinterpret_borrow<py::array_t<double>>(array);
}

}  // namespace

void Problem::Add(const py::object& object, const py::object& loss,
                  const py::sequence& blocks) {
  if (!py::isinstance<AnyFactor>(object)) {
    throw InputError("factor: is a " + TypeName(object) +
                     "; it needs a factor, such as RelativePoseFactor");
  }
  FactorProblem::Term term;
  term.factor = object.cast<const AnyFactor&>();
  if (!loss.is_none()) {
    if (!py::isinstance<py::str>(loss)) {
      throw InputError("loss: is a " + TypeName(loss) +
                       "; it needs a name, such as 'huber', or None");
    }
    if (term.factor.degrees == 0) {
      throw InputError("loss: must be None, as a " + TypeName(object) +
                       " has its own");
    }
    term.loss = ParseLoss(loss.cast<std::string>()).Make(term.factor.degrees);
  }
  CheckBlockCount(term.factor, "blocks", blocks.size());
  const size_t before = arrays_.size();
  try {
    for (size_t i = 0; i < blocks.size(); ++i) {
      const std::string where = "blocks[" + std::to_string(i) + "]";
      const int index = Hold(blocks[i], term.factor.blocks[i], where);
      const auto same =
          std::find(term.blocks.begin(), term.blocks.end(), index);
      if (same != term.blocks.end()) {
        throw InputError(where + ": is blocks[" +
                         std::to_string(same - term.blocks.begin()) +
                         "] again; the blocks of a factor differ");
      }
      term.blocks.push_back(index);
    }
  } catch (...) {
    while (arrays_.size() > before) DropLast();
    throw;
  }
  problem_.terms.push_back(std::move(term));
}

int Problem::IndexOf(const py::object& block, const std::string& where) const {
  const py::array_t<double> array = BlockArray(block, where);
  const auto found = indices_.find(array.data());
  // An array (N, 7) begins where its first pose does.
  if (found == indices_.end() || array.ndim() != 1 ||
      array.size() != problem_.blocks[found->second].kind.size) {
    throw InputError(where +
                     ": is not in the problem; add a residual block "
                     "over it first");
  }
  return found->second;
}

FactorProblem Problem::Load() const {
  FactorProblem copy = problem_;
  for (size_t i = 0; i < arrays_.size(); ++i) {
    std::vector<double>& x = copy.blocks[i].x;
    const double* const from = Memory(i);
    std::copy_n(from, x.size(), x.begin());
    bool is_valid = std::all_of(x.begin(), x.end(),
                                [](double v) { return std::isfinite(v); });
    if (IsPose(copy.blocks[i].kind)) {
      Eigen::Map<Eigen::Vector4d> q(x.data());
      is_valid = is_valid && q.norm() > 0.0;
      q.normalize();
    }
    if (!is_valid) {
      throw InputError(NameOf(i) +
                       ": is not finite, or has a quaternion of length 0");
    }
  }
  return copy;
}

void Problem::Store(const FactorProblem& solved) const {
  // Another thread may have added more blocks since then.
  const size_t count = solved.blocks.size();
  std::vector<double*> to;
  for (size_t i = 0; i < count; ++i) to.push_back(Memory(i));
  for (size_t i = 0; i < count; ++i) {
    const FactorProblem::Block& block = solved.blocks[i];
    if (!block.is_constant) std::copy(block.x.begin(), block.x.end(), to[i]);
  }
}

std::string Problem::InWords() const {
  const auto constant = std::count_if(
      problem_.blocks.begin(), problem_.blocks.end(),
      [](const FactorProblem::Block& block) { return block.is_constant; });
  return "Problem(" + std::to_string(problem_.terms.size()) + " factors over " +
         std::to_string(problem_.blocks.size()) + " blocks, " +
         std::to_string(constant) + " constant)";
}

int Problem::Hold(const py::object& object, const factors::BlockKind& kind,
                  const std::string& where) {
  const py::array_t<double> array = BlockArray(object, where);
  if (array.ndim() != 1 || array.size() != kind.size) {
    throw InputError(where + ": has shape " +
                     std::string(py::str(array.attr("shape"))) + "; a " +
                     kind.name + " needs (" + std::to_string(kind.size) + ",)");
  }
  const double* const begin = array.data();
  const auto next = indices_.lower_bound(begin);
  const auto overlaps = [&](const auto& other) {
    return other.first < begin + kind.size &&
           begin < other.first + problem_.blocks[other.second].kind.size;
  };
  if (next != indices_.end() && next->first == begin &&
      problem_.blocks[next->second].kind.size == kind.size) {
    return next->second;
  }
  if ((next != indices_.end() && overlaps(*next)) ||
      (next != indices_.begin() && overlaps(*std::prev(next)))) {
    throw InputError(where + ": overlaps another block of the problem");
  }
  const int index = static_cast<int>(arrays_.size());
  indices_.emplace(begin, index);
  arrays_.push_back(array);
  problem_.blocks.push_back({kind, std::vector<double>(kind.size)});
  return index;
}

void Problem::DropLast() {
  indices_.erase(arrays_.back().data());
  arrays_.pop_back();
  problem_.blocks.pop_back();
}

double* Problem::Memory(size_t i) const {
  py::array_t<double> array = BlockArray(arrays_[i], NameOf(i));
  const auto found = indices_.find(array.data());
  if (array.size() != problem_.blocks[i].kind.size || found == indices_.end() ||
      found->second != static_cast<int>(i)) {
    throw InputError(NameOf(i) + ": has another size now");
  }
  return array.mutable_data();
}

std::string Problem::NameOf(size_t i) const {
  return "block " + std::to_string(i) + " of the problem, a " +
         problem_.blocks[i].kind.name;
}

}  // namespace rgbd_pose
