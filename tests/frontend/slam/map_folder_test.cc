#include "frontend/slam/map_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <future>
#include <map>
#include <random>
#include <regex>
#include <thread>
#include <tuple>

#include "core/util/text_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/map_parts.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::UnorderedElementsAreArray;

// File names in a folder.
std::vector<std::string> Names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

// The names of the files that a map should have.
std::vector<std::string> NamesOf(const KeyframeMap& map) {
  std::vector<std::string> names = {"map.txt"};
  for (const Keyframe& keyframe : map.keyframes) {
    names.push_back(keyframe.images.gray->checksum + ".png");
    names.push_back(keyframe.images.depth->checksum + ".png");
  }
  return names;
}

// Identifies a file and its writing: changes if the file is written again.
std::pair<ino_t, fs::file_time_type> Identity(const std::string& file) {
  struct stat status = {};
  stat(file.c_str(), &status);
  return {status.st_ino, fs::last_write_time(file)};
}

class MapFolderTest : public testing::Test {
 protected:
  void ExpectLoadRefused(const std::vector<std::string>& message_parts) {
    ExpectInputError([this] { LoadMap(map_); }, message_parts);
  }

  // Expects that the folder takes no map, now or later.
  static void ExpectSaveRefused(const std::string& folder,
                                const std::string& message) {
    ExpectInputError([&] { SaveMap(folder, NoiseMap(2, 1)); }, {message});
    ExpectInputError([&] { RequireMapFolder(folder); }, {message});
  }

  const TempFolder folder_;
  const std::string map_ = folder_ / "maps/kitchen";
};

TEST_F(MapFolderTest, GivesBackWhatWasSaved) {
  const KeyframeMap saved = NoiseMap(5, 0);
  SaveMap(map_, saved);
  const KeyframeMap loaded = LoadMap(map_);
  EXPECT_TRUE(IsSameMap(loaded, saved));
  EXPECT_TRUE(std::signbit(loaded.keyframes[0].world_from_cam.translation.y()));
  const std::string index = ReadTextFile(map_ + "/map.txt");
  SaveMap(map_, loaded);
  EXPECT_EQ(ReadTextFile(map_ + "/map.txt"), index);
  SaveMap(map_, NoiseMap(0, 0));
  EXPECT_TRUE(IsSameMap(LoadMap(map_), NoiseMap(0, 0)));
}

// Maps from before keyframes had a timing covariance and a direction, and edges
// an origin.
TEST_F(MapFolderTest, ReadsMapsWithoutTheNewerWords) {
  KeyframeMap saved = NoiseMap(5, 0);
  SaveMap(map_, saved);
  const std::string index = ReadTextFile(map_ + "/map.txt");
  std::string older = index.substr(0, index.find("checksum"));
  older = std::regex_replace(
      older, std::regex("(\nkeyframe( [^ \n]+){14})[^\n]*"), "$1");
  older = std::regex_replace(older, std::regex(" tracked\n"), "\n");
  older = std::regex_replace(older, std::regex("\nup [^\n]*"), "");
  WriteFileAtomically(map_ + "/map.txt", older + ChecksumLine(older));
  for (Keyframe& keyframe : saved.keyframes) {
    keyframe.timing_covariance.setZero();
  }
  for (MapEdge& edge : saved.edges) edge.is_tracked = false;
  saved.ups.clear();
  EXPECT_TRUE(IsSameMap(LoadMap(map_), saved));
}

TEST_F(MapFolderTest, KeepsEveryLens) {
  KeyframeMap saved = NoiseMap(1, 0);
  for (const auto& [model, coefficients, words] :
       {std::tuple(LensModel::kRational, std::vector<double>{1, 2, 3, 4, 5},
                   12),
        std::tuple(LensModel::kRational,
                   std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}, 16),
        std::tuple(LensModel::kEquidistant, std::vector<double>{1, 2, 3, 4},
                   16)}) {
    ASSERT_TRUE(saved.camera.SetDistortion(model, coefficients));
    SaveMap(map_, saved);
    const KeyframeMap loaded = LoadMap(map_);
    EXPECT_EQ(loaded.CheckCamera(saved.camera), "");
    EXPECT_EQ(loaded.camera.Distortion(), coefficients);
    const std::string index = ReadTextFile(map_ + "/map.txt");
    const size_t line = index.find("\ncamera ") + 1;
    const std::string camera =
        index.substr(line, index.find('\n', line) - line);
    EXPECT_EQ(std::count(camera.begin(), camera.end(), ' ') + 1, words);
  }
  Camera other = saved.camera;
  other.lens_model = LensModel::kRational;
  EXPECT_NE(saved.CheckCamera(other), "");
}

TEST_F(MapFolderTest, WritesOnlyWhatIsNew) {
  const KeyframeMap small = NoiseMap(3, 0);
  SaveMap(map_, small);
  std::map<std::string, std::pair<ino_t, fs::file_time_type>> before;
  for (const std::string& name : NamesOf(small)) {
    before[name] = Identity(map_ + "/" + name);
  }
  const KeyframeMap grown = NoiseMap(5, 0);
  SaveMap(map_, grown);
  EXPECT_TRUE(IsSameMap(LoadMap(map_), grown));
  for (const auto& [name, identity] : before) {
    EXPECT_EQ(Identity(map_ + "/" + name) == identity, name != "map.txt");
  }
}

TEST_F(MapFolderTest, RemovesWhatNoMapNeeds) {
  SaveMap(map_, NoiseMap(5, 0));
  WriteFileAtomically(map_ + "/0123456789abcdef.png.partial", "x");
  WriteFileAtomically(map_ + "/map.txt.partial", "x");
  WriteFileAtomically(map_ + "/notes.txt", "the user's");
  WriteFileAtomically(map_ + "/0123456789abcdef.txt", "the user's");
  const KeyframeMap other = NoiseMap(2, 1);
  SaveMap(map_, other);
  std::vector<std::string> expected = NamesOf(other);
  expected.push_back("notes.txt");
  expected.push_back("0123456789abcdef.txt");
  EXPECT_THAT(Names(map_), UnorderedElementsAreArray(expected));
}

// A file whose size differs from the expected size is written again.
TEST_F(MapFolderTest, MendsACutImage) {
  const KeyframeMap map = NoiseMap(2, 0);
  SaveMap(map_, map);
  fs::resize_file(map_ + "/" + NamesOf(map)[1], 10);
  SaveMap(map_, map);
  EXPECT_TRUE(IsSameMap(LoadMap(map_), map));
}

TEST_F(MapFolderTest, RefusesWhatIsNoMapOfThisVersion) {
  ExpectLoadRefused({map_ + ": no such folder"});
  fs::create_directories(map_);
  ExpectLoadRefused({map_, "contains no map (no map.txt)"});
  const std::string newer = "rgbd_pose_map 2\nsubmap 1\n";
  for (const auto& [text, message] :
       {std::pair(std::string("a map of the kitchen\n"), "is not a map"),
        {"", "is not a map"},
        {newer + ChecksumLine(newer),
         "has format version 2, this program reads version 1 only; use a newer "
         "program"},
        // Other line ends, by an editor or a checkout on Windows, are an edit.
        {"rgbd_pose_map 1\r\nchecksum 0\r\n", "is damaged or edited"}}) {
    folder_.Write("maps/kitchen/map.txt", text);
    ExpectLoadRefused({map_ + "/map.txt: " + message});
  }
}

TEST_F(MapFolderTest, RefusesAChangedByteOfAnImage) {
  const KeyframeMap map = NoiseMap(1, 0);
  SaveMap(map_, map);
  for (const std::string& name : {NamesOf(map)[1], NamesOf(map)[2]}) {
    const std::string bytes = ReadTextFile(map_ + "/" + name);
    for (size_t i = 0; i < bytes.size(); i += 3) {
      SCOPED_TRACE(i);
      std::string changed = bytes;
      changed[i] ^= 1 << i % 8;
      folder_.Write("maps/kitchen/" + name, changed);
      ExpectLoadRefused({name + ": is damaged (wrong checksum)"});
    }
    folder_.Write("maps/kitchen/" + name, bytes);
  }
  EXPECT_NO_THROW(LoadMap(map_));
  fs::remove(map_ + "/" + NamesOf(map)[2]);
  ExpectLoadRefused({NamesOf(map)[2] + ": image of a keyframe is missing"});
}

TEST_F(MapFolderTest, SavesNothingThatIsNotSound) {
  const KeyframeMap good = NoiseMap(2, 0);
  SaveMap(map_, good);
  KeyframeMap wrong = NoiseMap(2, 1);
  wrong.edges[0].cur = 77;
  ExpectInputError([&] { SaveMap(map_, wrong); },
                   {map_ + ": not saved: edge from keyframe -3 to 77"});
  EXPECT_THAT(Names(map_), UnorderedElementsAreArray(NamesOf(good)));
}

TEST_F(MapFolderTest, RefusesFoldersOfOtherThings) {
  folder_.Write("photos/cat.png", "x");
  ExpectSaveRefused(
      folder_ / "photos",
      folder_ / "photos: contains files that are not part of a map");
  EXPECT_THAT(Names(folder_ / "photos"), testing::ElementsAre("cat.png"));
  ExpectSaveRefused(folder_ / "photos/cat.png", "no map can be saved here (");
  for (const auto& [text, message] :
       {std::pair("the way to the lake\n", "is not a map of rgbd_slam"),
        std::pair("rgbd_pose_map 2\n", "has format version 2")}) {
    folder_.Write("lake/map.txt", text);
    ExpectSaveRefused(folder_ / "lake", folder_ / "lake/map.txt: " + message);
    EXPECT_EQ(ReadTextFile(folder_ / "lake/map.txt"), text);
  }
  ExpectSaveRefused("/proc/none/map", "no map can be saved here (");
  RequireMapFolder(map_);
  EXPECT_TRUE(fs::is_empty(map_));
  // Files left by a program killed before its first map is complete.
  folder_.Write("maps/kitchen/0123456789abcdef.png", "x");
  folder_.Write("maps/kitchen/fedcba9876543210.png.partial", "x");
  folder_.Write("maps/kitchen/map.txt.partial", "x");
  ExpectLoadRefused({"contains no map"});
  SaveMap(map_, NoiseMap(1, 0));
  EXPECT_THAT(Names(map_), UnorderedElementsAreArray(NamesOf(NoiseMap(1, 0))));
}

TEST_F(MapFolderTest, OneAtATimeSaves) {
  SaveMap(map_, NoiseMap(1, 0));
  const int other = open(map_.c_str(), O_RDONLY);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  ExpectSaveRefused(map_,
                    map_ +
                        ": another program is saving a map here; wait for "
                        "it or choose another folder");
  EXPECT_TRUE(IsSameMap(LoadMap(map_), NoiseMap(1, 0)));
  close(other);
  SaveMap(map_, NoiseMap(2, 1));
}

// The reader in docs/maps.md.
TEST_F(MapFolderTest, IsReadByAFewLinesOfPython) {
  if (std::system("command -v python3 >/dev/null") != 0) {
    GTEST_SKIP() << "no python3";
  }
  const KeyframeMap map = NoiseMap(2, 0);
  SaveMap(map_, map);
  const std::string command =
      "python3 -B " RGBD_POSE_EXAMPLES "/read_map.py " + map_;
  const RunResult run = RunCommand(command, folder_);
  EXPECT_EQ(run.err, "");
  const auto line = [&](int i, const std::string& place) {
    return "keyframe " + std::to_string(map.keyframes[i].id) + " at " + place +
           " " + map_ + "/" + NamesOf(map)[1 + 2 * i] + " " + map_ + "/" +
           NamesOf(map)[2 + 2 * i] + "\n";
  };
  EXPECT_EQ(run.out,
            line(0, "1.0471975511965976 -0 3.141592653589793e-300") +
                line(1, "4.1887902047863905 -0 3.141592653589793e-300") +
                "edge from -3 to 4\n");
  WriteFileAtomically(map_ + "/" + NamesOf(map)[3], "x");
  EXPECT_NE(RunCommand(command, folder_).exit_code, 0);
  EXPECT_EQ(
      RunCommand("python3 -B " RGBD_POSE_EXAMPLES "/read_map.py", folder_).err,
      "usage: read_map.py FOLDER\n");
}

// A FIFO blocks the reader of an image. Meanwhile another map is saved, which
// removes all images of the map being loaded.
TEST_F(MapFolderTest, LoadsWhileAnotherSaves) {
  const KeyframeMap first = NoiseMap(2, 1);
  const KeyframeMap second = NoiseMap(2, 2);
  SaveMap(map_, first);
  const std::string image = map_ + "/" + NamesOf(first)[1];
  fs::remove(image);
  ASSERT_EQ(mkfifo(image.c_str(), 0600), 0);
  const auto other = std::async(std::launch::async, [&] {
    const int reader_waits = open(image.c_str(), O_WRONLY);
    SaveMap(map_, second);
    close(reader_waits);
  });
  EXPECT_TRUE(IsSameMap(LoadMap(map_), second));
}

// A process that alternately saves two maps until it is killed.
class Saver {
 public:
  Saver(const std::string& folder, const KeyframeMap (&maps)[2], int first)
      : process_(fork()) {
    if (process_ != 0) return;
    try {
      for (int i = first;; ++i) SaveMap(folder, maps[i % 2]);
    } catch (...) {
      _exit(1);
    }
  }
  ~Saver() {
    kill(process_, SIGKILL);
    int status = 0;
    waitpid(process_, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "ended by itself";
  }

 private:
  const pid_t process_;
};

// The maps share no image, so each replaces all images of the other.
TEST_F(MapFolderTest, SurvivesKills) {
  const KeyframeMap maps[] = {NoiseMap(4, 1), NoiseMap(3, 2)};
  SaveMap(map_, maps[0]);
  const auto start = std::chrono::steady_clock::now();
  SaveMap(map_, maps[1]);
  SaveMap(map_, maps[0]);
  // Some of the processes must have the time for several saves.
  const std::chrono::duration<double> longest =
      2.0 * (std::chrono::steady_clock::now() - start);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int found[2] = {};
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    {
      const Saver saver(map_, maps, i);
      std::this_thread::sleep_for(share(random) * longest);
    }
    const KeyframeMap loaded = LoadMap(map_);
    const bool is_second = IsSameMap(loaded, maps[1]);
    ASSERT_TRUE(is_second || IsSameMap(loaded, maps[0]));
    ++found[is_second];
  }
  EXPECT_GT(found[0], 0);
  EXPECT_GT(found[1], 0);
  SaveMap(map_, maps[0]);
  EXPECT_THAT(Names(map_), UnorderedElementsAreArray(NamesOf(maps[0])));
}

}  // namespace
}  // namespace rgbd_pose
