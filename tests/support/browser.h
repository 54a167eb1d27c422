#pragma once

#include <cstdlib>
#include <sstream>
#include <string>

#include "tests/support/run_program.h"

namespace rgbd_pose {

inline bool HasBrowser() {
  return std::system("command -v chromium >/dev/null") == 0;
}

// Opens a page in the browser; `action` is a list of its flags. Temporary files
// are in `folder`.
inline RunResult Browse(const std::string& page, const std::string& action,
                        const TempFolder& folder) {
  return RunCommand(
      "timeout 60 chromium --headless --no-sandbox --disable-gpu "
      "--disable-quic --no-first-run --disable-background-networking "
      "--disable-component-update --disable-sync --enable-unsafe-swiftshader "
      "--enable-logging=stderr --virtual-time-budget=10000 --user-data-dir=" +
          (folder / "browser") + " " + action + " file://" + page,
      folder);
}

// The browser's messages about the page, without its advice on speed.
inline std::string Console(const RunResult& browser) {
  std::istringstream lines(browser.err);
  std::string line, result;
  while (std::getline(lines, line)) {
    if (line.find("CONSOLE") == std::string::npos) continue;
    if (line.find("Canvas2D: ") != std::string::npos) continue;
    if (line.find("GL Driver Message") != std::string::npos) continue;
    result += line + "\n";
  }
  return result;
}

}  // namespace rgbd_pose
