#include "core/util/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <future>
#include <string>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;

TEST(TextFileTest, ReadsColumnsOfAllUsualForms) {
  const struct {
    const char* what;
    const char* content;
  } kCases[] = {
      {"plain", "1 a\n\n2 b\n"},
      {"no line end at the end", "1 a\n\n2 b"},
      {"Windows line ends", "1 a\r\n\r\n2 b\r\n"},
      {"byte order mark",
       "\xEF\xBB\xBF"
       "1 a\n\n2 b\n"},
      {"commas and tabs", "1,a\n\n\t2 ,\t b ,\n"},
      {"comments", "1 a # b c\n#1 a\n2 b#\n"},
  };
  const TempFolder folder;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.what);
    const auto lines = ReadTextTable(folder.Write("table.txt", c.content));
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].number, 1);
    EXPECT_EQ(lines[1].number, 3);
    EXPECT_THAT(lines[0].words, ElementsAre("1", "a"));
    EXPECT_THAT(lines[1].words, ElementsAre("2", "b"));
  }
}

TEST(TextFileTest, ReadsAnEmptyFileAsNoLines) {
  const TempFolder folder;
  EXPECT_TRUE(ReadTextTable(folder.Write("empty.txt", "")).empty());
}

TEST(TextFileTest, RefusesTablesInUtf16) {
  const TempFolder folder;
  for (const char* start : {"\xFF\xFE", "\xFE\xFF"}) {
    const std::string path = folder.Write("rgb.txt", start);
    ExpectInputError([&] { ReadTextTable(path); },
                     {path, "is text in UTF-16; save it as UTF-8"});
  }
}

TEST(TextFileTest, NamesTheFileItCannotRead) {
  const TempFolder folder;
  ExpectInputError([&] { ReadTextTable(folder / "missing.txt"); },
                   {folder / "missing.txt"});
  ExpectInputError([&] { ReadTextFile(folder.path()); },
                   {folder.path() + ": is a folder"});
}

TEST(TextFileTest, ParsesNumbers) {
  const auto parse = [](const char* word) {
    return ParseNumber(word, "file", 7, "tx");
  };
  EXPECT_EQ(parse("1305031098.665900"), 1305031098.6659);
  EXPECT_EQ(parse("-2.5e-3"), -0.0025);
  EXPECT_EQ(parse("+4"), 4.0);
  for (const char* word :
       {"", "x", "1x", "1,5", "nan", "-NaN", "inf", "1e999", "+", "++1", "-"}) {
    SCOPED_TRACE(word);
    ExpectInputError([&] { parse(word); }, {"file:7: '" + std::string(word) +
                                            "' is not a finite number for tx"});
  }
}

TEST(TextFileTest, TimeStampsAreInSeconds) {
  const auto parse = [](const char* word) {
    return ParseTimestamp(word, "file", 7);
  };
  EXPECT_EQ(parse("1305031098.665900"), 1305031098.6659);
  EXPECT_EQ(parse("-2.5"), -2.5);
  for (const char* word : {"1305031098665", "1305031098665900000", "-1e300"}) {
    ExpectInputError(
        [&] { parse(word); },
        {"file:7: time stamp " + std::string(word) + " is not in seconds"});
  }
}

// A file that cannot be read to its end must not be taken for a short file.
TEST(TextFileTest, TellsOfAnErrorOnTheWay) {
  const std::string unreadable = "/proc/self/mem";  // nothing at address 0
  if (!std::filesystem::exists(unreadable)) GTEST_SKIP() << "no /proc";
  ExpectInputError([&] { ReadTextFile(unreadable); },
                   {unreadable + ": cannot be read"});
}

TEST(TextFileTest, ReplacesAFileAsAWhole) {
  const TempFolder folder;
  const std::string file = folder / "a.txt";
  WriteFileAtomically(file, "old and long");
  WriteFileAtomically(file, "new");
  EXPECT_EQ(ReadTextFile(file), "new");
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

// Checks that the file is written; it cannot check that it is on the disk.
TEST(TextFileTest, WritesToTheDisk) {
  const TempFolder folder;
  WriteFileAtomically(folder / "a.txt", "new", Durability::kPowerLoss);
  SyncFolder(folder.path());
  EXPECT_EQ(ReadTextFile(folder / "a.txt"), "new");
  ExpectInputError([&] { SyncFolder(folder / "none"); },
                   {folder / "none: cannot be synchronised"});
}

TEST(TextFileTest, NamesTheFileItCannotWrite) {
  const TempFolder folder;
  ExpectInputError([&] { WriteFileAtomically(folder / "none/a.txt", "x"); },
                   {folder / "none/a.txt"});
  // A folder of that name: renaming fails and leaves nothing behind.
  folder.Write("b.txt/inside", "x");
  ExpectInputError([&] { WriteFileAtomically(folder / "b.txt", "x"); },
                   {folder / "b.txt"});
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

// Two programs may have the same output, or two threads of Python.
TEST(TextFileTest, ContentsOfTwoWritersAreNotMixed) {
  const TempFolder folder;
  const std::string file = folder / "a.txt";
  constexpr int kTimes = 200;
  const auto write = [&file](size_t size, char sign) {
    for (int i = 0; i < kTimes; ++i) {
      WriteFileAtomically(file, std::string(size, sign));
    }
  };
  WriteFileAtomically(file, "b");
  std::future<void> one = std::async(std::launch::async, write, 300000, 'a');
  std::future<void> other = std::async(std::launch::async, write, 200000, 'b');
  for (int i = 0; i < kTimes; ++i) {
    RequireWritable(file);
    const std::string content = ReadTextFile(file);
    ASSERT_EQ(content.find_first_not_of(content[0]), content.npos);
  }
  EXPECT_NO_THROW(one.get());
  EXPECT_NO_THROW(other.get());
}

// For root, nothing else would keep a file from taking the place of /dev/null.
TEST(TextFileTest, LeavesDevicesAndPipesAlone) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ExpectInputError([&] { WriteFileAtomically(pipe, "x"); },
                   {pipe + ": is a device or a pipe, but a file is expected"});
  ExpectInputError([&] { RequireWritable(pipe); }, {pipe + ": is a device"});
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(TextFileTest, TellsAheadWhatItCannotWrite) {
  const TempFolder folder;
  ExpectInputError([&] { RequireWritable(folder / "none/a.txt"); },
                   {folder / "none/a.txt"});
  ExpectInputError([&] { RequireWritable(folder.path()); }, {folder.path()});
  RequireWritable(folder / "a.txt");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  folder.Write("a.txt", "x");
  RequireWritable(folder / "a.txt");
  EXPECT_EQ(ReadTextFile(folder / "a.txt"), "x");
}

TEST(TextFileTest, ListsMayHaveSpacesAndKeepEmptyParts) {
  using Parts = std::vector<std::string>;
  EXPECT_EQ(SplitList(" a, b c ,,"), (Parts{"a", "b c", "", ""}));
  EXPECT_EQ(SplitList("  "), Parts{""});
  EXPECT_EQ(SplitList("a +b", '+'), (Parts{"a", "b"}));
  EXPECT_EQ(SplitText("a, b", ','), (Parts{"a", " b"}));
}

}  // namespace
}  // namespace rgbd_pose
