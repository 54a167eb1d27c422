#include "core/util/named_values.h"

#include "core/util/text_file.h"

namespace rgbd_pose {

InputError UnknownName(const std::string& what, const std::string& name,
                       const std::vector<std::string>& names) {
  return InputError("unknown " + what + " '" + name +
                    "'; available: " + Join(names));
}

}  // namespace rgbd_pose
