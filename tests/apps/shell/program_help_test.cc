#include "apps/shell/program_help.h"

#include <gmock/gmock.h>

namespace rgbd_pose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ProgramHelp SmallHelp() {
  return {"rgbd_small",
          "does little.",
          "rgbd_small recording --loss=tukey",
          {{"Group",
            {{"loss", "string", "tukey", "a loss", {"tukey", "huber"}},
             {"file", "string", "", ".txt [of poses]: the camera's, m/s^2", {}},
             {"sigma", "double", "0.5", "a number", {}},
             {"report", "bool", "true", "a switch", {}}}}},
          /*takes_recording=*/true};
}

TEST(ProgramHelpTest, ManualPageShowsSignsAsTheyAre) {
  const std::string page = FormatManualPage(SmallHelp());
  EXPECT_THAT(page,
              HasSubstr("\n\\&.txt [of poses]: the camera\\(aqs, m/s\\(ha2\n"));
  EXPECT_THAT(page, HasSubstr("\nrgbd_small \\- does little\n"));
  EXPECT_THAT(page, HasSubstr("\n\\fB\\-\\-[no]report\\fR\n"));
  EXPECT_THAT(page, HasSubstr("\nNames: tukey, huber.\n"));
  EXPECT_THAT(page, HasSubstr("\n\\fBrgbd_slam\\fR(1)"));
}

TEST(ProgramHelpTest, BashCompletesNamesFilesAndSwitches) {
  const std::string script = FormatBashCompletion(SmallHelp());
  EXPECT_THAT(script,
              HasSubstr(" --loss= --file= --sigma= --report --noreport"));
  EXPECT_THAT(script, HasSubstr("  --loss) names=\"tukey huber\" ;;\n"));
  EXPECT_THAT(script, HasSubstr("  --sigma) return ;;\n"));
  EXPECT_THAT(script, HasSubstr("  --flagfile | --file)\n"));
}

TEST(ProgramHelpTest, ZshGetsQuotedDescriptions) {
  const std::string script = FormatZshCompletion(SmallHelp());
  EXPECT_THAT(script,
              HasSubstr("'--file=[.txt \\[of poses\\]: the camera'\\''s, "
                        "m/s^2]:text:_files'"));
  EXPECT_THAT(script, HasSubstr("'--sigma=[a number]:number: '"));
  EXPECT_THAT(script, HasSubstr("compadd -- tukey huber"));
}

TEST(ProgramHelpTest, OnlySomeProgramsTakeARecording) {
  ProgramHelp help = SmallHelp();
  EXPECT_THAT(FormatHelp(help), HasSubstr("may be the first word"));
  help.takes_recording = false;
  for (const HelpFormat format : {FormatHelp, FormatManualPage,
                                  FormatBashCompletion, FormatZshCompletion}) {
    EXPECT_THAT(format(help), Not(HasSubstr("first word")));
    EXPECT_THAT(format(help), Not(HasSubstr("recording:")));
  }
}

}  // namespace
}  // namespace rgbd_pose
