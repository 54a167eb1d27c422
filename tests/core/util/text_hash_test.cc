#include "core/util/text_hash.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

std::string HashOf(const std::vector<std::string>& texts) {
  TextHash hash;
  for (const std::string& text : texts) hash.Add(text);
  return hash.Hex();
}

TEST(TextHashTest, IsFnv1a) {
  EXPECT_EQ(TextHash().Hex(), "cbf29ce484222325");  // FNV's offset basis
  // "a" and the bytes 1 0 0 0 0 0 0 0, by another implementation.
  EXPECT_EQ(HashOf({"a"}), "dedf9f982e43402d");
}

TEST(TextHashTest, TellsTextsApart) {
  EXPECT_EQ(HashOf({"a", "bc"}), HashOf({"a", "bc"}));
  EXPECT_NE(HashOf({"a", "bc"}), HashOf({"ab", "c"}));
  EXPECT_NE(HashOf({"", "a"}), HashOf({"a", ""}));
  EXPECT_NE(HashOf({"a", "b"}), HashOf({"b", "a"}));
}

}  // namespace
}  // namespace rgbd_pose
