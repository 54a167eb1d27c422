#include <gflags/gflags.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "apps/shell/program.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

DEFINE_string(test_word, "", "");
DEFINE_bool(test_switch, false, "");
DEFINE_int32(test_number, 0, "");

namespace rgbd_pose {
namespace {

TEST(FlagReaderTest, TakesTheFormsOfGflags) {
  ReadFlags({"--test_word=a=b c", "-test_number", "-3", "--test_switch"});
  EXPECT_EQ(FLAGS_test_word, "a=b c");
  EXPECT_EQ(FLAGS_test_number, -3);
  EXPECT_TRUE(FLAGS_test_switch);
  ReadFlags({"--notest_switch", "--test_word="});
  EXPECT_FALSE(FLAGS_test_switch);
  EXPECT_EQ(FLAGS_test_word, "");
  ReadFlags({"--test_switch=true", "--test_number=1", "--test_number=2"});
  EXPECT_TRUE(FLAGS_test_switch);
  EXPECT_EQ(FLAGS_test_number, 2) << "the last one counts";
}

// Shells do not replace it in --flag=~/path.
TEST(FlagReaderTest, KnowsTheHomeFolder) {
  const char* const before = std::getenv("HOME");
  const std::string home = before == nullptr ? "" : before;
  setenv("HOME", "/home/me", 1);
  const std::pair<std::string, std::string> kCases[] = {
      {"~/runs/x", "/home/me/runs/x"},
      {"~", "/home/me"},
      {"~/a,~/b", "/home/me/a,/home/me/b"},
      {"a~/b", "a~/b"},
      {"~other/x", "~other/x"},
      {"./~/x", "./~/x"},
      {"a, b,", "a, b,"},
      {",", ","}};
  for (const auto& [word, value] : kCases) {
    ReadFlags({"--test_word=" + word});
    EXPECT_EQ(FLAGS_test_word, value);
    ReadFlags({"--test_word", word});
    EXPECT_EQ(FLAGS_test_word, value);
  }
  unsetenv("HOME");
  ExpectInputError([] { ReadFlags({"--test_word=~/x"}); },
                   {"'~/x': there is no home folder (HOME)"});
  setenv("HOME", home.c_str(), 1);
}

TEST(FlagReaderTest, ReadsFilesInTheirPlace) {
  const TempFolder folder;
  const std::string inner =
      folder.Write("inner", "\xEF\xBB\xBF--test_number=4\r\n");
  const std::string outer = folder.Write(
      "outer", "# Title\n\n  --test_word=x \n--flagfile=" + inner + "\n");
  ReadFlags({"--test_number=1", "--flagfile", outer, "--test_word=y"});
  EXPECT_EQ(FLAGS_test_number, 4);
  EXPECT_EQ(FLAGS_test_word, "y");
}

TEST(FlagReaderTest, RefusesAllElse) {
  const TempFolder folder;
  const std::string file = folder.Write("file", "# a\ntest_number=4\n");
  const std::string circle = folder / "circle";
  folder.Write("circle", "--flagfile=" + circle + "\n");
  const struct {
    std::vector<std::string> words;
    std::string message;
  } kCases[] = {
      {{"--test_wrd=a"}, "unknown flag --test_wrd; did you mean --test_word?"},
      {{"--tests"}, "unknown flag --tests; --help lists the flags"},
      {{"--test_word=a,", "b"},
       "'b' is not a flag; lists have no space after the comma"},
      {{"--test_word", "", "b"}, "'b' is not a flag; flags look like"},
      {{"word"}, "'word' is not a flag"},
      {{"-"}, "'-' is not a flag"},
      {{"--"}, "'--' is not a flag"},
      {{std::string("--flagfile\0=a", 13)}, "is not a flag"},
      {{"--notest_word"}, "unknown flag --notest_word"},
      {{"--notest_switch=true"}, "unknown flag --notest_switch"},
      {{"--test_word"}, "--test_word needs a value"},
      {{"--test_number=x"}, "'x' is not a valid int32 for --test_number"},
      {{"--test_number=1.5"}, "'1.5' is not a valid int32 for --test_number"},
      {{"--test_number=99999999999"}, "'99999999999' is not a valid int32"},
      {{"--test_switch=perhaps"}, "'perhaps' is not a valid bool"},
      {{"--fromenv=test_word"}, "unknown flag --fromenv"},
      {{"--helpxml"}, "unknown flag --helpxml"},
      {{"--help"}, "unknown flag --help"},
      {{"--flagfile=" + file}, file + ":2: 'test_number=4' is not a flag"},
      {{"--flagfile=" + circle}, "include each other in a loop"},
      {{"--flagfile=" + folder.path()}, "is a folder"},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.words[0]);
    ExpectInputError([&] { ReadFlags(c.words); }, {c.message});
  }
}

}  // namespace
}  // namespace rgbd_pose
