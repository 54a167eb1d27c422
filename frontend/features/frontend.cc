#include "frontend/features/frontend.h"

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/features/descriptor_frontend.h"
#include "frontend/features/descriptor_matching.h"
#include "frontend/features/klt_frontend.h"
#include "frontend/features/patch_frontend.h"

namespace rgbd_pose {
namespace {

struct FrontendEntry {
  std::string_view name;
  std::unique_ptr<Frontend> (*make)(const FrontendOptions& options);
};

template <typename Type>
FrontendEntry EntryOf() {
  return {Type::kName,
          [](const FrontendOptions& options) -> std::unique_ptr<Frontend> {
            return std::make_unique<Type>(options);
          }};
}

template <const DescriptorMethod& method>
FrontendEntry EntryOf() {
  return {method.name,
          [](const FrontendOptions& options) -> std::unique_ptr<Frontend> {
            return std::make_unique<DescriptorFrontend>(options, method);
          }};
}

// A new frontend needs one header and one row here.
const FrontendEntry kFrontends[] = {
    EntryOf<KltFrontend>(), EntryOf<PatchFrontend>(), EntryOf<kOrb>(),
    EntryOf<kSift>(),       EntryOf<kAkaze>(),
};

}  // namespace

std::string FrontendOptions::Check() const {
  std::string camera_error = camera.Check();
  if (!camera_error.empty()) return camera_error;
  const std::string noise_error = depth_noise.Check();
  if (!noise_error.empty()) return "depth noise: " + noise_error;
  if (max_features < 3 || max_features > 1000000) {
    return "max_features must be 3 to 1000000";
  }
  if (!(min_depth > 0.0) || !(max_depth > min_depth)) {
    return "depth limits must satisfy 0 < min_depth < max_depth";
  }
  return "";
}

std::vector<std::string> FrontendNames() { return NamesOf(kFrontends); }

std::unique_ptr<Frontend> MakeFrontend(std::string_view name,
                                       const FrontendOptions& options) {
  RequireSound(options.Check(), "frontend: ");
  return RowOf(kFrontends, "frontend", name).make(options);
}

}  // namespace rgbd_pose
