#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {

// A copy of a good sequence of four frames, which a row of a table damages.
struct SpoiledSequence {
  std::string path;

  std::string operator/(const std::string& name) const {
    return path + "/" + name;
  }
  std::string Read(const std::string& name) const {
    return ReadTextFile(*this / name);
  }
  void Write(const std::string& name, const std::string& content) const {
    WriteFileAtomically(*this / name, content);
  }
  void Cut(const std::string& name, size_t size) const {
    std::filesystem::resize_file(*this / name, size);
  }
  void Remove(const std::string& name) const {
    std::filesystem::remove_all(*this / name);
  }
  // Replaces the first occurrence of `from`.
  void Replace(const std::string& name, const std::string& from,
               const std::string& to) const {
    std::string content = Read(name);
    const size_t at = content.find(from);
    ASSERT_NE(at, std::string::npos) << from << " is not in " << name;
    Write(name, content.replace(at, from.size(), to));
  }
};

// A bad input, or one that only looks bad.
struct BadInput {
  std::string name;
  std::function<void(const SpoiledSequence&)> spoil;  // null: no change
  // Further arguments of the program, or all of them where the table says so.
  // {dir} is the folder of the test, {seq} the sequence's.
  std::string words;
  int exit_code = 0;
  std::string message;  // in the single line on stderr, with {dir} and {seq}
};

// Words that a program refuses, and what it says of them.
struct BadWords {
  std::string words;
  std::string message;
};

// Runs the rows of tables and checks what programs guarantee: the exit code,
// one line on stderr with the program's name, complete results or none.
class BadInputTest : public testing::Test {
 protected:
  BadInputTest();

  // Runs the rows of a table, each with its words added to `command`.
  void ExpectEach(const std::string& command,
                  const std::vector<BadInput>& rows) const;

  // Expects that each of these words, added to `command`, is bad input of a
  // program whose sequence is good, or changed by `spoil`.
  void ExpectRefused(
      const std::string& command, const std::vector<BadWords>& rows,
      const std::function<void(const SpoiledSequence&)>& spoil = nullptr) const;

  // Expects that each of these flags is needed, where it is given without
  // value.
  void ExpectNeeded(const std::string& command,
                    const std::vector<std::string>& flags) const;

  // Replaces {dir} and {seq}.
  std::string Fill(std::string text) const;

  // rgbd_odometry with the sequence, its camera and {dir}/out as the output.
  static std::string Odometry();

  // Puts the good sequence in {seq} and removes {dir}/out.
  void Renew() const;

  SpoiledSequence Spoiled() const { return {folder_ / "seq"}; }

  const TempFolder folder_;

 private:
  void Expect(const std::string& command, const BadInput& row) const;
};

}  // namespace rgbd_pose
