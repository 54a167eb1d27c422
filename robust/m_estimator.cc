#include "robust/m_estimator.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "core/util/input_error.h"
#include "robust/losses.h"

namespace rgbd_pose {
namespace {

using LossPointer = std::unique_ptr<ceres::LossFunction>;

template <typename Loss>
LossPointer Make(double width) {
  return std::make_unique<Loss>(width);
}

LossPointer MakeL1(double width) {
  return std::make_unique<PowerLoss>(1.0, width);
}

LossPointer MakeLp(double width) {
  return std::make_unique<PowerLoss>(1.2, width);
}

LossPointer MakeL1L2(double width) {
  return std::make_unique<ceres::SoftLOneLoss>(std::sqrt(2.0) * width);
}

// -2 ln of the density of the t distribution with p components, (nu + p)
// ln(1 + s / (nu c^2)), scaled to R'(0) = 1: Cauchy's loss of another width.
LossPointer MakeStudentT(double width) {
  constexpr double kDegreesOfFreedom = 5.0;  // as DVO (Kerl et al., ICRA 2013)
  return std::make_unique<ceres::CauchyLoss>(std::sqrt(kDegreesOfFreedom) *
                                             width);
}

MEstimator Tuned(std::string_view name, std::string_view formula,
                 LossPointer (*make)(double width),
                 const std::array<double, MEstimator::kMaxDimension>& width95) {
  return {name, formula, make, width95};
}

}  // namespace

// tests/robust/m_estimator_width_test.cc recomputes the widths by quadrature.
// Student's t keeps the sigma as its scale, at an efficiency of 92 to 94 %: at
// 95 % it would be Cauchy's loss.
const std::vector<MEstimator>& MEstimators() {
  static const std::vector<MEstimator>& rows = *new std::vector<MEstimator>{
      {"none", "1", nullptr},
      {"l1", "c / x", MakeL1},
      Tuned("l1_l2", "(1 + (x/c)^2 / 2)^-0.5", MakeL1L2,
            {0.9101, 0.9259, 0.9137, 0.8801, 0.8277, 0.7561}),
      {"lp", "(x/c)^-0.8", MakeLp},
      Tuned("fair", "1 / (1 + x/c)", Make<LossOf<Fair>>,
            {1.3998, 1.2226, 1.0440, 0.8703, 0.7034, 0.5434}),
      Tuned("huber", "1 if x <= c, c / x beyond", Make<HuberLoss>,
            {1.3450, 1.5011, 1.6280, 1.7311, 1.8120, 1.8693}),
      Tuned("cauchy", "1 / (1 + (x/c)^2)", Make<ceres::CauchyLoss>,
            {2.3849, 2.5486, 2.6656, 2.7516, 2.8154, 2.8624}),
      Tuned("geman_mcclure", "(1 + (x/c)^2)^-2", Make<GemanMcClureLoss>,
            {3.7874, 4.0956, 4.3373, 4.5354, 4.7024, 4.8460}),
      Tuned("welsch", "exp(-(x/c)^2)", Make<LossOf<Welsch>>,
            {2.9846, 3.2510, 3.4691, 3.6552, 3.8186, 3.9646}),
      Tuned("tukey", "(1 - (x/c)^2)^2 if x <= c, 0 beyond", Make<TukeyLoss>,
            {4.6851, 5.1230, 5.4902, 5.8103, 6.0963, 6.3562}),
      Tuned("barron", "(1 + (x/c)^2 / 3)^-1.5", Make<LossOf<Barron>>,
            {1.8238, 1.9655, 2.0743, 2.1613, 2.2329, 2.2928}),
      {"student_t", "1 / (1 + (x/c)^2 / 5)", MakeStudentT},
  };
  return rows;
}

std::vector<std::string> MEstimatorNames() { return NamesOf(MEstimators()); }

NamedLoss ParseLoss(const std::string& text) {
  const size_t open = text.find('(');
  const MEstimator* const row = FindNamed(MEstimators(), text.substr(0, open));
  if (row == nullptr) throw UnknownName("loss", text, MEstimatorNames());
  if (open == std::string::npos) return {row, 0.0};
  double width = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + open + 1, end, width);
  const bool is_number = read.ec == std::errc() && read.ptr + 1 == end &&
                         *read.ptr == ')' && width >= 1e-3 && width <= 1e3;
  if (!is_number || row->make == nullptr) {
    throw InputError("loss '" + text +
                     "': the width must be a number from 0.001 to 1000, as in "
                     "huber(1.5); 'none' has no width");
  }
  return {row, width};
}

}  // namespace rgbd_pose
