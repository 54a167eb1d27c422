#include "frontend/files/depth_noise_file.h"

#include <algorithm>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/nearest_name.h"
#include "core/util/text_file.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {

std::string FormatDepthNoiseFile(const DepthNoiseModel& model) {
  return Format(
      "# Standard deviation (m) of one measured depth z (m):\n"
      "# sigma(z) = constant + quadratic * (z - centre)^2\n"
      "constant: %.9g\n"
      "quadratic: %.9g\n"
      "centre: %.9g\n"
      "# Standard deviation of the mean of 3 x 3 depths, as a share of sigma.\n"
      "mean_share: %.9g\n",
      model.constant, model.quadratic, model.centre, model.mean_share);
}

DepthNoiseModel ReadDepthNoiseFile(const std::string& path) {
  const YamlSection file = YamlSection::FromFile(path);
  const std::vector<std::string> keys = {"constant", "quadratic", "centre",
                                         "mean_share"};
  for (const std::string& key : file.Keys()) {
    if (std::count(keys.begin(), keys.end(), key) > 0) continue;
    const std::string meant = NearestName(key, keys, 2);
    file.Fail(key, "is no key of a noise of depth" +
                       (meant.empty() ? ": " + Join(keys)
                                      : "; did you mean " + meant + "?"));
  }
  DepthNoiseModel model;
  model.name = path;
  model.constant = file.Number("constant");
  model.quadratic = file.Number("quadratic");
  model.centre = file.NumberOr("centre", model.centre);
  model.mean_share = file.NumberOr("mean_share", model.mean_share);
  RequireSound(model.Check(), path + ": ");
  const double sigma = model.sigma(1.0);
  if (sigma > 1.0) {
    throw InputError(path + Format(": sigma is %.3g m at a depth of 1 m; are "
                                   "the values in metres?",
                                   sigma));
  }
  return model;
}

DepthNoiseModel ResolveDepthNoise(const std::string& name_or_file) {
  if (const auto* row = FindNamed(DepthNoiseModels(), name_or_file)) {
    return *row;
  }
  if (IsFile(name_or_file)) return ReadDepthNoiseFile(name_or_file);
  throw InputError("unknown depth noise '" + name_or_file +
                   "': no such file; available models: " +
                   Join(NamesOf(DepthNoiseModels())));
}

}  // namespace rgbd_pose
