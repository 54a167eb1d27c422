#pragma once

#include <stdexcept>
#include <string>

namespace rgbd_pose {

// Thrown for bad input from outside (files, images, settings). The message is
// one line that says what is wrong, where (file:line if there is one) and what
// to do about it. Programs print it and exit with code 2. Control
// characters of quoted input become spaces, so that it stays one line.
class InputError : public std::runtime_error {
 public:
  // The message; the second form puts the place (file:line) before it.
  explicit InputError(const std::string& message)
      : std::runtime_error(OneLine(message)) {}
  InputError(const std::string& file, int line, const std::string& message)
      : InputError(file + ":" + std::to_string(line) + ": " + message) {}

 private:
  static std::string OneLine(std::string message) {
    for (char& c : message) {
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    }
    return message;
  }
};

// Throws what a Check() says, with `before` before it, unless it is empty.
inline void RequireSound(const std::string& problem,
                         const std::string& before = "") {
  if (!problem.empty()) throw InputError(before + problem);
}

}  // namespace rgbd_pose
