#include "frontend/files/depth_noise_file.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

TEST(DepthNoiseFileTest, IsReadAsItIsWritten) {
  const TempFolder folder;
  const DepthNoiseModel model = {"", 1.25e-3, 2.375e-3, 0.4, 0.5};
  const std::string path =
      folder.Write("noise.yaml", FormatDepthNoiseFile(model));
  const DepthNoiseModel read = ResolveDepthNoise(path);
  EXPECT_EQ(read.name, path);
  EXPECT_DOUBLE_EQ(read.constant, model.constant);
  EXPECT_DOUBLE_EQ(read.quadratic, model.quadratic);
  EXPECT_DOUBLE_EQ(read.centre, model.centre);
  EXPECT_DOUBLE_EQ(read.mean_share, model.mean_share);
}

TEST(DepthNoiseFileTest, WithoutACentreItIsAtTheCamera) {
  const TempFolder folder;
  const std::string path =
      folder.Write("noise.yaml", "constant: 0.001\nquadratic: 0.002\n");
  EXPECT_DOUBLE_EQ(ReadDepthNoiseFile(path).sigma(2.0), 9e-3);
  EXPECT_DOUBLE_EQ(ReadDepthNoiseFile(path).mean_share, 1.0);
}

TEST(DepthNoiseFileTest, ANameIsThatOfTheTable) {
  EXPECT_EQ(ResolveDepthNoise("nguyen").quadratic, 0.0019);
  ExpectInputError([] { ResolveDepthNoise("white"); },
                   {"unknown depth noise 'white'", "khoshelham"});
  ExpectInputError([] { ResolveDepthNoise("/no/such/noise.yaml"); },
                   {"/no/such/noise.yaml", "no such file"});
}

TEST(DepthNoiseFileTest, SaysWhatIsWrongWithAFile) {
  const TempFolder folder;
  struct Wrong {
    const char* text;
    const char* says;
  };
  for (const Wrong& wrong :
       {Wrong{"", "constant"}, Wrong{"constant: 0.001\n", "quadratic"},
        Wrong{"constant: much\nquadratic: 0\n", "constant"},
        Wrong{"constant: .nan\nquadratic: 0\n", "constant"},
        Wrong{"constant: -0.001\nquadratic: 0.001\n", "must not be negative"},
        Wrong{"constant: 0.001\nquadratic: 0\nmean_share: 2\n", "mean_share"},
        Wrong{"constant: 0\nquadratic: 0\n", "above 0 for all depths"},
        Wrong{"constant: 1.5\nquadratic: 2.5\n", "are the values in metres?"},
        Wrong{"constant: 0.001\nquadratic: 0.002\ncenter: 0.4\n",
              "center is no key of a noise of depth; did you mean centre?"},
        Wrong{"constant: 0.001\nquadratic: 0.002\nlinear: 0.4\n",
              "linear is no key of a noise of depth: constant, quadratic"},
        Wrong{"constant: [\n", "YAML"}}) {
    const std::string path = folder.Write("noise.yaml", wrong.text);
    ExpectInputError([&] { ReadDepthNoiseFile(path); }, {path, wrong.says});
  }
}

}  // namespace
}  // namespace rgbd_pose
