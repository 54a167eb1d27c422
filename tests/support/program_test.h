#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {

// A camera file of images that take a quarter of the time to render.
constexpr char kSmallCamera[] =
    "Camera.fx: 262.5\nCamera.fy: 262.5\nCamera.cx: 159.5\nCamera.cy: 119.5\n"
    "Camera.width: 320\nCamera.height: 240\n";

// Runs programs in a folder, on recordings that it renders.
class ProgramTest : public testing::Test {
 protected:
  RunResult Run(const std::string& command) const {
    return RunCommand(command, folder_);
  }

  std::string Read(const std::string& file) const {
    return ReadTextFile(folder_ / file);
  }

  // Renders a recording with small images, unless a flag names another camera.
  void Render(const std::string& name, const std::string& flags) const {
    const RunResult run =
        Run(RGBD_SIMULATE " --output='" + (folder_ / name) + "' --camera=" +
            folder_.Write("small.yaml", kSmallCamera) + " " + flags);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }

  const TempFolder folder_;
};

}  // namespace rgbd_pose
