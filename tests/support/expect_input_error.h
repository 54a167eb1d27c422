#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/util/input_error.h"

namespace rgbd_pose {

// Expects that a call throws an InputError with a message of one line that
// contains all parts.
inline void ExpectInputError(const std::function<void()>& call,
                             const std::vector<std::string>& message_parts) {
  try {
    call();
    ADD_FAILURE() << "took bad input";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    for (const std::string& part : message_parts) {
      EXPECT_THAT(error.what(), testing::HasSubstr(part));
    }
  }
}

}  // namespace rgbd_pose
