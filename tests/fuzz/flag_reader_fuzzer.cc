// Flag files, such as the config.flags of a run.

#include <gflags/gflags.h>

#include "apps/shell/program.h"
#include "tests/fuzz/fuzz_input.h"

DEFINE_string(word, "", "one of each type that the programs use");
DEFINE_bool(toggle, false, "");
DEFINE_int32(whole, 0, "");
DEFINE_uint32(seed, 0, "");
DEFINE_double(real, 0.0, "");

FUZZ_TARGET(flag_reader) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("f", FuzzText(data, size));
  MayRefuse([&] { ReadFlags({"--flagfile=" + file}); });
  return 0;
}
