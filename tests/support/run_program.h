#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {

// Exit code and output of a program.
struct RunResult {
  int exit_code = -1;  // -1: ended by a signal
  std::string out;
  std::string err;
};

// How often a word is in a text, such as a program's output.
inline int CountOf(const std::string& word, const std::string& text) {
  int count = 0;
  for (size_t at = 0; (at = text.find(word, at)) != std::string::npos;
       at += word.size()) {
    ++count;
  }
  return count;
}

// Runs a shell command with empty input; stores its output in `folder`
// meanwhile.
inline RunResult RunCommand(const std::string& command,
                            const TempFolder& folder) {
  const std::string out = folder / "stdout";
  const std::string err = folder / "stderr";
  const int status = std::system(
      (command + " </dev/null >'" + out + "' 2>'" + err + "'").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadTextFile(out),
          ReadTextFile(err)};
}

}  // namespace rgbd_pose
