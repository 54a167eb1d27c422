// Files of a depth noise model (YAML).

#include <cmath>

#include "frontend/files/depth_noise_file.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(depth_noise_file) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("noise.yaml", FuzzText(data, size));
  MayRefuse([&] {
    const DepthNoiseModel model = ReadDepthNoiseFile(file);
    Require(model.Check().empty(), "a model that can be used");
    const double sigma = model.sigma(1.0);
    Require(std::isfinite(sigma) && sigma > 0.0, "a positive deviation");
    const std::string again =
        folder.Write("again.yaml", FormatDepthNoiseFile(model));
    Require(
        std::abs(ReadDepthNoiseFile(again).sigma(1.0) - sigma) <= 1e-6 * sigma,
        "a model that is written as it is");
  });
  return 0;
}
