#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// Files that must not exist unless a run was complete.
bool IsResult(const fs::path& path) {
  const std::string name = path.filename().string();
  for (const char* result :
       {"metrics.json", "trajectory.txt", "frames.csv", "errors.csv",
        "report.html", "config.flags", "done.json", "summary.csv", "tables.csv",
        "report.md", "sweep.csv"}) {
    if (name == result) return true;
  }
  return path.extension() == ".partial";
}

std::vector<std::string> ResultsBelow(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (IsResult(entry.path())) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The name of the program in a command.
std::string NameOf(const std::string& command) {
  const std::string kBefore = "bin/rgbd_";
  const size_t begin = command.find(kBefore) + 4;
  return command.substr(begin, command.find(' ', begin) - begin);
}

}  // namespace

BadInputTest::BadInputTest() {
  folder_.Write("small.yaml",
                "Camera.fx: 262\nCamera.fy: 262\nCamera.cx: 160\n"
                "Camera.cy: 120\nCamera.width: 320\nCamera.height: 240\n");
  const RunResult run =
      RunCommand(Fill(RGBD_SIMULATE " --frames=4 --camera={dir}/small.yaml "
                                    "--output={dir}/good"),
                 folder_);
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

std::string BadInputTest::Odometry() {
  return RGBD_ODOMETRY
      " --dataset={seq} --camera={seq}/camera.yaml --output={dir}/out "
      "--noreport ";
}

std::string BadInputTest::Fill(std::string text) const {
  const std::pair<std::string, std::string> kPlaces[] = {
      {"{dir}", folder_.path()}, {"{seq}", Spoiled().path}};
  for (const auto& [place, path] : kPlaces) {
    for (size_t at; (at = text.find(place)) != std::string::npos;) {
      text.replace(at, place.size(), path);
    }
  }
  return text;
}

void BadInputTest::Renew() const {
  fs::remove_all(Spoiled().path);
  fs::remove_all(folder_ / "out");
  fs::copy(folder_ / "good", Spoiled().path, fs::copy_options::recursive);
}

void BadInputTest::ExpectEach(const std::string& command,
                              const std::vector<BadInput>& rows) const {
  for (const BadInput& row : rows) {
    SCOPED_TRACE(row.name);
    Renew();
    if (row.spoil) row.spoil(Spoiled());
    Expect(Fill(command + row.words), row);
  }
}

void BadInputTest::ExpectRefused(
    const std::string& command, const std::vector<BadWords>& rows,
    const std::function<void(const SpoiledSequence&)>& spoil) const {
  for (const BadWords& row : rows) {
    ExpectEach(command, {{row.words, spoil, row.words, 2, row.message}});
  }
}

void BadInputTest::ExpectNeeded(const std::string& command,
                                const std::vector<std::string>& flags) const {
  for (const std::string& flag : flags) {
    const std::string message = flag + " is needed";
    ExpectEach(command, {{message, nullptr, flag + "=", 1, message}});
  }
}

void BadInputTest::Expect(const std::string& command,
                          const BadInput& row) const {
  const std::vector<std::string> before = ResultsBelow(folder_.path());
  RunResult run = RunCommand(command, folder_);
  ASSERT_EQ(run.exit_code, row.exit_code) << run.err;
  if (row.exit_code == 0) {
    EXPECT_EQ(run.err, "");
    return;
  }
#ifndef RGBD_POSE_HAS_LIBDEFLATE
  // libpng may have printed messages before.
  const size_t own = run.err.find(NameOf(command) + ": ");
  if (own != std::string::npos) run.err.erase(0, own);
#endif
  EXPECT_THAT(run.err, testing::StartsWith(NameOf(command) + ": "));
  EXPECT_THAT(run.err, testing::HasSubstr(Fill(row.message)));
  EXPECT_THAT(run.err, testing::Not(testing::HasSubstr("unexpected")));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  if (row.exit_code > 2) return;  // ran to its end
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(ResultsBelow(folder_.path()), before);
  EXPECT_TRUE(!fs::exists(folder_ / "out") || fs::is_empty(folder_ / "out"));
}

}  // namespace rgbd_pose
