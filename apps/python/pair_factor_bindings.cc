#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/any_factor.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/matches.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "costs/cost_factory.h"
#include "costs/factors/pair.h"
#include "frontend/settings/settings.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// Estimators narrow their default loss step by step; a factor has to lead to
// the motion from a poor start by itself, and this loss pulls from any
// distance.
constexpr char kLoss[] = "cauchy";

constexpr Named<PairMounting::Blocks> kMountings[] = {
    {"constant", PairMounting::kNone},
    {"shared", PairMounting::kShared},
    {"each", PairMounting::kEach},
};

// A PairFactor with the matches that it was made of.
struct BoundPair : AnyFactor {
  explicit BoundPair(std::unique_ptr<PairFactor> pair_factor)
      : pair(pair_factor.get()) {
    blocks.resize(pair->parameter_block_sizes().size(),
                  factors::KindsOf(BlockList<PoseBlock>()).front());
    function =
        std::make_shared<const SharedCostFunction>(std::move(pair_factor));
  }

  void Associate(const Rigid3d& cur_from_ref) const {
    const auto lock = function->Lock();
    pair->Associate(cur_from_ref);
  }

  PairFactor* pair;  // in `function`
};

RobustCost CostFrom(const std::string& cost, const std::string& loss) {
  std::vector<RobustCost> costs = MakeRobustCosts(cost, loss);
  if (costs.size() == 1) return std::move(costs.front());
  throw InputError("cost: '" + cost +
                   "' is a sum; add a PairFactor for each of its costs");
}

// Returns a function that makes a factor of two arrays of rows.
auto Maker(ToObservation to_observation, const char* ref_name,
           const char* cur_name) {
  return [=](const py::object& ref, const py::object& cur,
             const RgbdCamera* camera, const py::object& initial_guess,
             const std::string& cost, const std::string& loss, double sigma_px,
             const py::object& normals_cur, const std::string& depth_noise,
             const std::string& mounting, const py::object& body_from_ref_cam,
             const py::object& body_from_cur_cam) {
    const auto rigid = [](const py::object& object, const char* name) {
      return object.is_none() ? Rigid3d() : RigidFromArray(object, name);
    };
    const MatchArrays arrays(ref, ref_name, cur, cur_name, normals_cur,
                             sigma_px);
    RobustCost robust_cost = CostFrom(cost, loss);
    const Rigid3d guess = rigid(initial_guess, "initial_guess");
    PairMounting place;
    place.blocks = RowOf(kMountings, "mounting", mounting).value;
    place.body_from_ref_cam = rigid(body_from_ref_cam, "body_from_ref_cam");
    place.body_from_cur_cam = rigid(body_from_cur_cam, "body_from_cur_cam");
    OdometrySettings settings;
    py::dict keywords;
    keywords["depth_noise"] = depth_noise;
    SetFromKeywords("PairFactor", keywords, SettingTable(&settings));
    const RgbdCamera seen_by = camera == nullptr ? RgbdCamera() : *camera;

    const ReleasedGil no_gil;
    const RowMatches matches = arrays.Make(seen_by.camera, to_observation,
                                           NoiseFor(settings, seen_by));
    auto pair = std::make_unique<PairFactor>(
        std::move(robust_cost), FramePair{&matches.matches}, guess, place);
    if (pair->cost().matches().empty()) {
      throw InputError(std::string(ref_name) + ": the cost " + cost +
                       " can use none of the " + std::to_string(arrays.size()) +
                       " matches; it needs finite rows with what this cost "
                       "compares, such as depths or normals");
    }
    return BoundPair(std::move(pair));
  };
}

}  // namespace

void BindPairFactor(py::module_* module) {
  py::class_<BoundPair, AnyFactor, std::shared_ptr<BoundPair>> pair(
      *module, "PairFactor", R"(
All matches of two frames under a cost and a loss, as one residual of 7 rows;
over the poses of `ref` and `cur`, and of mountings that are estimated.

Add it without a loss: it has its own.)");
  // Calls define(arguments...) with those that both kinds of rows have.
  const auto with_options = [](const auto& define, const auto&... first) {
    define(first..., py::kw_only(), py::arg("initial_guess") = py::none(),
           py::arg("cost") = kDefaultCost, py::arg("loss") = kLoss,
           py::arg("sigma_px") = 0.5, py::arg("normals_cur") = py::none(),
           py::arg("depth_noise") = "camera", py::arg("mounting") = "constant",
           py::arg("body_from_ref_cam") = py::none(),
           py::arg("body_from_cur_cam") = py::none());
  };
  with_options(
      [&pair](const auto&... arguments) {
        pair.def(py::init(Maker(ObservePoint, "points_ref", "points_cur")),
                 arguments..., R"(
points_ref, points_cur, camera, sigma_px, normals_cur, depth_noise, cost: as in
    estimate_motion, but a cost that is a sum needs a factor for each term.
loss: as in estimate_motion, but not narrowed step by step: one that leaves out
    wrong matches, such as tukey, needs a start near the motion.
initial_guess: (4, 4) cur_from_ref of the cameras, at which the cost chooses
    its residuals and weights; None: no motion. See associate.
mounting: "constant": blocks are the poses of two bodies, on which cameras are
    mounted at body_from_ref_cam and body_from_cur_cam, (4, 4); None: the body
    is the camera. "shared": a third block, body_from_cam of both, is estimated.
    "each": two more blocks, body_from_cam of `ref` and of `cur`.

Raises InputError for invalid arguments, and if the cost can use no match.)");
      },
      py::arg("points_ref"), py::arg("points_cur"),
      py::arg("camera") = py::none());
  with_options(
      [&pair](const auto&... arguments) {
        pair.def_static("from_pixels",
                        Maker(ObservePixel, "pixels_ref", "pixels_cur"),
                        arguments..., R"(
A factor of rows u v depth (px, m), as in estimate_motion_pixels. All other
arguments are those of the constructor.)");
      },
      py::arg("pixels_ref"), py::arg("pixels_cur"),
      py::arg("camera").none(false));
  pair.def(
      "associate",
      [](const BoundPair& self, const py::object& cur_from_ref) {
        const Rigid3d motion = RigidFromArray(cur_from_ref, "cur_from_ref");
        const ReleasedGil no_gil;
        self.Associate(motion);
      },
      py::arg("cur_from_ref"), R"(
Chooses residuals and weights again, at a (4, 4) motion of the cameras that a
solve has found; of use if it is far from the initial guess.)");
}

}  // namespace rgbd_pose
