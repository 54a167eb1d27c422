#pragma once

#include <stdexcept>
#include <string>

namespace rgbd_pose {

// Thrown for invalid input from outside (files, images, settings). The message
// is one line (control characters become spaces): what is wrong, where and how
// to fix it. Programs print it and exit with code 2.
class InputError : public std::runtime_error {
 public:
  // The second constructor puts the place (file:line) before the message.
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

// Throws InputError(before + problem) unless `problem` (of a Check()) is empty.
inline void RequireSound(const std::string& problem,
                         const std::string& before = "") {
  if (!problem.empty()) throw InputError(before + problem);
}

// Runs `call`; adds where it was and some advice to its InputError.
template <typename Call>
auto Located(const std::string& place, Call call,
             const std::string& advice = "") {
  try {
    return call();
  } catch (const InputError& error) {
    throw InputError(place + ": " + error.what() + advice);
  }
}

}  // namespace rgbd_pose
