#include "frontend/features/frontend.h"

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/features/descriptor_matching.h"

namespace rgbd_pose {
namespace {

template <const DescriptorMethod& method>
std::unique_ptr<Frontend> MakeDescriptorFrontendOf(
    const FrontendOptions& options) {
  return MakeDescriptorFrontend(options, method);
}

// A new frontend needs one function and one row here.
constexpr Named<std::unique_ptr<Frontend> (*)(const FrontendOptions& options)>
    kFrontends[] = {{"klt", MakeKltFrontend},
                    {"patch", MakePatchFrontend},
                    {"orb", MakeDescriptorFrontendOf<kOrb>},
                    {"sift", MakeDescriptorFrontendOf<kSift>},
                    {"akaze", MakeDescriptorFrontendOf<kAkaze>}};

}  // namespace

std::string FrontendOptions::Check() const {
  if (std::string error = camera.Check(); !error.empty()) return error;
  if (max_features < 3 || max_features > 1000000) {
    return "max_features must be 3 to 1000000";
  }
  if (!(feature_noise >= 0.01 && feature_noise <= 100.0)) {
    return "feature_noise must be 0.01 to 100";
  }
  return depth.Check();
}

void Frontend::ObserveAgain(const Frame& frame,
                            const Rigid3d& reference_from_stamp,
                            FeatureSet* features) const {
  const Camera& camera = options_.camera;
  for (size_t i = 0; i < features->points.size(); ++i) {
    const cv::Point2f& point = features->points[i];
    Observation& o = features->observations[i];
    o = MovedObservation(
        Observe(frame, camera, point.x, point.y, o.sigma_px, options_.depth),
        camera, reference_from_stamp);
  }
}

std::vector<std::string> FrontendNames() { return NamesOf(kFrontends); }

std::unique_ptr<Frontend> MakeFrontend(std::string_view name,
                                       const FrontendOptions& options) {
  RequireSound(options.Check(), "frontend: ");
  return RowOf(kFrontends, "frontend", name).value(options);
}

}  // namespace rgbd_pose
