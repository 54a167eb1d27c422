#include "core/util/locked_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "core/util/input_error.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

TEST(LockedFolderTest, BelongsToOneProgramAndIsRemovedInTheEnd) {
  const TempFolder folder;
  const fs::path path = folder / "new";
  {
    folder.Write("new/old.txt", "left by a killed program");
    const LockedFolder mine(path, "mine");
    EXPECT_TRUE(fs::is_empty(path));
    folder.Write("new/file.txt", "");
    EXPECT_THROW(LockedFolder(path, "other"), InputError);
    EXPECT_TRUE(fs::exists(path / "file.txt"));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(LockedFolderTest, WhatWasCreatedForItIsRemovedIfItIsEmpty) {
  const TempFolder folder;
  folder.Write("old/file.txt", "");
  { const LockedFolder failed(folder / "runs/new/partial", "failed"); }
  EXPECT_FALSE(fs::exists(folder / "runs"));
  const LockedFolder ended(folder / "old/new/partial", "ended");
  LockedFolder::RemoveAll();
  EXPECT_FALSE(fs::exists(folder / "old/new"));
  EXPECT_TRUE(fs::exists(folder / "old"));
  {
    const LockedFolder done(folder / "runs/new/partial", "done");
    folder.Write("runs/new/results.txt", "");
  }
  EXPECT_TRUE(fs::exists(folder / "runs/new/results.txt"));
}

TEST(LockedFolderTest, WithSomethingPreciousIsNotEmptied) {
  const TempFolder folder;
  folder.Write("new/list.txt", "recorded by a killed program");
  ExpectInputError(
      [&] { LockedFolder(folder / "new", "camera:", "list.txt"); },
      {"camera: " + folder / "new", "rename it to keep it, or remove it"});
  EXPECT_TRUE(fs::exists(folder / "new/list.txt"));
  const LockedFolder other(folder / "new", "camera", "table.txt");
  EXPECT_FALSE(fs::exists(folder / "new/list.txt"));
}

TEST(LockedFolderTest, AllAreRemovedBeforeAProgramEnds) {
  const TempFolder folder;
  const LockedFolder first(folder / "first", "first");
  const LockedFolder moved(folder / "moved", "moved");
  const LockedFolder kept(folder / "kept", "kept", "list.txt");
  { const LockedFolder gone(folder / "gone", "gone"); }
  folder.Write("first/below/file.txt", "");
  folder.Write("kept/list.txt", "");
  fs::rename(folder / "moved", folder / "results");
  LockedFolder::RemoveAll();
  EXPECT_FALSE(fs::exists(folder / "first"));
  EXPECT_TRUE(fs::exists(folder / "results"));
  EXPECT_TRUE(fs::exists(folder / "kept/list.txt"));
}

TEST(LockedFolderTest, ThatWasMovedLeavesTheNextOneAlone) {
  const TempFolder folder;
  const fs::path path = folder / "new";
  std::optional<LockedFolder> first;
  first.emplace(path, "first");
  fs::rename(path, folder / "moved");
  const LockedFolder second(path, "second");
  first.reset();
  EXPECT_TRUE(fs::exists(folder / "moved"));
  EXPECT_TRUE(fs::exists(path));
}

}  // namespace
}  // namespace rgbd_pose
