#include "frontend/sources/tum_writer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/sources/imu_beside.h"
#include "frontend/sources/open_source.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

class TumWriterTest : public testing::Test {
 protected:
  TumWriterTest() {
    options_.frames = 4;
    options_.camera.camera = {160,       120,  130.5, 131.25, 79.5, 59.5,
                              0.1 / 3.0, 0.02, 0.0,   0.001,  0.0};
    options_.camera.depth_scale = 1000.0;
  }

  void Write(const std::string& folder, const TumWriterOptions& writer = {}) {
    SyntheticDataset dataset(options_);
    WriteTumSequence(&dataset, folder, writer);
  }
  // Reads the written sequence with the camera that was written.
  SourceOptions Written() const {
    SourceOptions options;
    options.path = folder_;
    options.camera = ReadCameraFile(folder_ + "/camera.yaml");
    return options;
  }

  const TempFolder parent_;
  const std::string folder_ = parent_ / "new/sequence";
  SyntheticOptions options_;
};

TEST_F(TumWriterTest, KeepsTheInertialSensor) {
  SyntheticImuOptions imu;
  imu.cam_from_imu =
      Rigid3d::FromRotationVector({0.7, -1.1, 0.4}, {0.01, 0.02, 0.03});
  imu.delay_s = 0.005;
  auto dataset = std::make_unique<SyntheticDataset>(options_);
  const std::vector<ImuSample> samples = dataset->SimulateImu(imu);
  const auto source =
      WithImu(std::move(dataset), samples,
              {{imu.cam_from_imu, imu.delay_s, imu.densities}, true});
  const WrittenSequence written = WriteTumSequence(source.get(), folder_);
  EXPECT_EQ(written.imu_samples, static_cast<int>(samples.size()));
  SourceOptions options;
  options.path = folder_;
  const auto read = OpenSource("auto", options);
  ASSERT_TRUE(read->imu().has_value());
  const ImuCalibration known = read->imu()->calibration;
  EXPECT_TRUE((*known.cam_from_imu * Eigen::Vector3d(1, 2, 3))
                  .isApprox(imu.cam_from_imu * Eigen::Vector3d(1, 2, 3)));
  EXPECT_EQ(known.delay_s, 0.005);
  EXPECT_EQ(known.noise->gyro_walk, imu.densities.gyro_walk);
  std::vector<ImuSample> all;
  while (const std::optional<RgbdFrame> next = read->Next()) {
    all.insert(all.end(), next->imu.begin(), next->imu.end());
  }
  ASSERT_EQ(all.size(), samples.size());
  constexpr double kTolerance = 1e-9;  // digits of the stamps
  for (size_t k = 0; k < all.size(); ++k) {
    EXPECT_NEAR(all[k].stamp, samples[k].stamp, kTolerance);
    EXPECT_EQ(all[k].gyro, samples[k].gyro);
    EXPECT_EQ(all[k].accel, samples[k].accel);
  }
}

TEST_F(TumWriterTest, WritesWhatIsKnownOfTheCameraAlone) {
  Write(folder_);
  // A simulated shutter is known, even if all rows are exposed at once.
  EXPECT_NE(ReadTextFile(folder_ + "/camera.yaml").find("color_readout: 0"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ + "/imu.csv"));
  EXPECT_FALSE(fs::exists(folder_ + "/imu.yaml"));
}

TEST_F(TumWriterTest, ReadsBackAsWritten) {
  options_.color_shutter = {-0.0075, 0.028};
  options_.depth_shutter = {0.0125, -0.027};
  SyntheticDataset dataset(options_);
  std::vector<int> told;
  TumWriterOptions writer;
  writer.progress = [&told](int done) { told.push_back(done); };
  WriteTumSequence(&dataset, folder_ + "/", writer);
  EXPECT_EQ(told, (std::vector<int>{1, 2, 3, 4}));

  SourceOptions options = Written();
  const RgbdCamera camera = RegisteredCamera(*options.camera);
  EXPECT_EQ(camera.depth_scale, 1000.0);
  for (const CameraParameter& parameter : kCameraParameters) {
    EXPECT_EQ(camera.camera.*parameter.value,
              options_.camera.camera.*parameter.value)
        << parameter.name;
  }
  for (const ShutterParameter& parameter : kShutterParameters) {
    EXPECT_EQ(camera.*parameter.image.*parameter.value,
              dataset.camera().*parameter.image.*parameter.value)
        << parameter.name;
  }
  options.keep_color = true;
  const auto read = OpenTum(options);
  ASSERT_EQ(read->size(), dataset.size());
  for (int i = 0; i < dataset.size(); ++i) {
    const Frame written = dataset.Read(i), frame = read->Read(i);
    EXPECT_EQ(read->timestamp(i), dataset.timestamp(i));
    EXPECT_EQ(cv::norm(frame.color, written.color, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(frame.depth, written.depth, cv::NORM_INF), 0.0);
  }
  const Trajectory truth = ReadTrajectory(folder_ + "/groundtruth.txt");
  ASSERT_EQ(truth.size(), 4u);
  constexpr double kTolerance = 1e-9;  // rounding of the text
  for (int i = 0; i < dataset.size(); ++i) {
    const Rigid3d off =
        truth[i].world_from_cam.Inverse() * dataset.WorldFromCam(i);
    EXPECT_EQ(truth[i].timestamp, dataset.timestamp(i));
    EXPECT_LT(off.translation.norm(), 2 * kTolerance);
    EXPECT_LT(off.Angle(), 4 * kTolerance);
  }
}

// As with gray levels from a JPEG: trajectories must not change.
TEST_F(TumWriterTest, KeepsGrayLevelsThatAreNotThoseOfTheColours) {
  class Unrelated final : public Dataset {
   public:
    explicit Unrelated(const RgbdCamera& camera) : camera_(camera) {
      cv::RNG random(1);
      for (cv::Mat* image : {&frame_.gray, &frame_.color}) {
        image->create(120, 160, image == &frame_.gray ? CV_8UC1 : CV_8UC3);
        random.fill(*image, cv::RNG::UNIFORM, -20, 276, /*saturate=*/true);
      }
      frame_.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(1000));
    }
    int size() const override { return 1; }
    double timestamp(int) const override { return 1.0; }
    Frame Read(int) const override { return frame_; }
    const RgbdCamera& camera() const override { return camera_; }

   private:
    RgbdCamera camera_;
    Frame frame_;
  };
  Unrelated source(options_.camera);
  WriteTumSequence(&source, folder_);
  SourceOptions options;
  options.path = folder_;
  EXPECT_EQ(cv::norm(OpenTum(options)->Read(0).gray, source.Read(0).gray,
                     cv::NORM_INF),
            0.0);
}

TEST_F(TumWriterTest, DepthHasItsOwnTime) {
  options_.depth_delay_s = -0.0125;
  Write(folder_);
  const auto read = OpenTum(Written());
  ASSERT_EQ(read->size(), 4);
  for (int i = 0; i < read->size(); ++i) {
    EXPECT_EQ(read->timestamp(i), SyntheticDataset(options_).timestamp(i));
    EXPECT_NEAR(read->Read(i).depth_delay, -0.0125,
                1e-6);  // digits of the text
  }
}

// Depth images in another order, one for two frames.
TEST_F(TumWriterTest, KeepsPairsThatAreNotNearestInTime) {
  Write(folder_);
  const std::string list = parent_ / "pairs.txt";
  const SyntheticDataset dataset(options_);
  const auto name = [&](const std::string& kind, int i) {
    const std::string stamp = Format("%.6f", dataset.timestamp(i));
    return stamp + " " + kind + "/" + stamp + ".png";
  };
  WriteFileAtomically(list, name("rgb", 0) + " " + name("depth", 1) + "\n" +
                                name("rgb", 1) + " " + name("depth", 0) + "\n" +
                                name("rgb", 2) + " " + name("depth", 2) + "\n" +
                                name("rgb", 3) + " " + name("depth", 2) + "\n");
  SourceOptions options = Written();
  options.associations_file = list;
  const auto given = OpenTum(options);
  const std::string copy = parent_ / "copy";
  TumWriterOptions writer;
  writer.threads = 4;
  const WrittenSequence written =
      WriteTumSequence(OpenTum(options).get(), copy, writer);
  EXPECT_EQ(written.frames, 4);
  EXPECT_NE(written.remark.find("--associations"), std::string::npos);
  options.path = copy;
  options.associations_file = copy + "/associations.txt";
  const auto read = OpenTum(options);
  ASSERT_EQ(read->size(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(read->Read(i).depth_delay, given->Read(i).depth_delay, 2e-6);
    EXPECT_EQ(cv::norm(read->Read(i).depth, given->Read(i).depth, cv::NORM_INF),
              0.0);
  }
  options.associations_file.clear();
  EXPECT_EQ(OpenTum(options)->size(), 3);  // the lists are in order
}

TEST_F(TumWriterTest, ALinkToAnEmptyFolderIsFollowed) {
  fs::create_directories(folder_);
  const fs::path link = parent_ / "link";
  fs::create_directory_symlink(folder_, link);
  Write(link.string());
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::exists(folder_ + "/rgb.txt"));
}

TEST_F(TumWriterTest, TakesAnEmptyFolderButNoOther) {
  fs::create_directories(folder_);
  Write(folder_);
  EXPECT_TRUE(fs::exists(folder_ + "/rgb.txt"));
  EXPECT_THROW(Write(folder_), InputError);
  EXPECT_THROW(Write(parent_.Write("file", "text")), InputError);
}

TEST_F(TumWriterTest, LeavesNothingIfItFails) {
  TumWriterOptions writer;
  writer.progress = [](int done) {
    if (done == 2) throw std::runtime_error("stop");
  };
  EXPECT_THROW(Write(folder_, writer), std::runtime_error);
  EXPECT_FALSE(fs::exists(parent_ / "new"));
}

TEST_F(TumWriterTest, KeepsWhatThereIsWhenItIsStopped) {
  options_.frames = 60;
  for (const int threads : {1, 3}) {
    const std::string folder = folder_ + std::to_string(threads);
    TumWriterOptions writer;
    writer.threads = threads;
    writer.stop = [done = 0]() mutable { return ++done < 2 ? "" : "a signal"; };
    SyntheticDataset source(options_);
    const WrittenSequence written = WriteTumSequence(&source, folder, writer);
    EXPECT_EQ(written.stopped, "a signal");
    EXPECT_GE(written.frames, 2);
    EXPECT_LT(written.frames, 60);
    SourceOptions options;
    options.path = folder;
    options.camera = options_.camera;
    // All images that were begun are in the lists.
    EXPECT_EQ(OpenTum(options)->size(), written.frames);
    for (const char* kind : {"rgb", "depth"}) {
      EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(folder) / kind),
                              fs::directory_iterator()),
                written.frames);
    }
  }
}

TEST_F(TumWriterTest, IsNotStoppedAtItsLastFrame) {
  SyntheticDataset dataset(options_);
  TumWriterOptions writer;
  writer.threads = 1;
  writer.stop = [done = 0]() mutable { return ++done < 4 ? "" : "a signal"; };
  const WrittenSequence written = WriteTumSequence(&dataset, folder_, writer);
  EXPECT_EQ(written.frames, 4);
  EXPECT_EQ(written.stopped, "");
}

TEST_F(TumWriterTest, IsUndisturbedByWhatAnEarlierRunLeft) {
  const std::string left = folder_ + ".rgbd_convert.partial";
  parent_.Write("new/sequence.rgbd_convert.partial/old.txt", "text");
  parent_.Write("new/sequence.partial/mine.txt", "a user's");
  Write(folder_);
  EXPECT_FALSE(fs::exists(folder_ + "/old.txt"));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(folder_ + ".partial/mine.txt"));
}

}  // namespace
}  // namespace rgbd_pose
