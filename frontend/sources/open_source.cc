#include "frontend/sources/open_source.h"

#include <filesystem>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/sources/tum_dataset.h"

namespace rgbd_pose {
namespace {

constexpr char kAuto[] = "auto";

struct SourceType {
  const char* name;
  const char* what;  // it is, in words
  bool (*recognises)(const std::string& path);
  std::unique_ptr<FrameSource> (*open)(const SourceOptions& options);
};

template <typename Source>
std::unique_ptr<FrameSource> Open(const SourceOptions& options) {
  return std::make_unique<Source>(options);
}

// The first that recognises a path has it.
constexpr SourceType kTypes[] = {
    {"tum", "a folder with rgb.txt and depth.txt",
     [](const std::string& path) {
       std::error_code error;  // what is missing in it, TumDataset says
       return std::filesystem::is_directory(path, error);
     },
     Open<TumDataset>},
};

}  // namespace

std::vector<std::string> SourceNames() {
  std::vector<std::string> names = NamesOf(kTypes);
  names.insert(names.begin(), kAuto);
  return names;
}

std::unique_ptr<FrameSource> OpenSource(const std::string& name,
                                        const SourceOptions& options) {
  std::string known;
  for (const SourceType& type : kTypes) {
    if (name == kAuto ? type.recognises(options.path) : name == type.name) {
      return type.open(options);
    }
    known += std::string(known.empty() ? "" : "; ") + type.what;
  }
  if (name != kAuto) throw UnknownName("source", name, SourceNames());
  std::error_code error;
  if (!std::filesystem::exists(options.path, error)) {
    throw InputError(options.path + ": no such folder");
  }
  throw InputError(options.path + ": is no known kind of recording: " + known);
}

}  // namespace rgbd_pose
