#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "apps/batch/batch_runs.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kMarker[] = "done.json";
constexpr char kPartial[] = ".partial";

void Check(const std::error_code& error, const std::string& folder) {
  if (error) {
    throw InputError(folder + ": cannot be created or replaced (" +
                     error.message() + ")");
  }
}

bool IsStatus(const std::string& word) {
  return word == "ok" || word == "failed" || word == "timeout" ||
         word == "crashed";
}

std::vector<fs::path> FoldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error)) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

// The kernel needs a moment to end the runs of a killed batch.
constexpr auto kPatience = std::chrono::seconds(1);
constexpr auto kRetryEvery = std::chrono::milliseconds(20);

// Opens and locks a file; `kind` is LOCK_EX (exclusive) or LOCK_SH (shared).
int Lock(const std::string& path, int kind) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT, 0666);
  if (file < 0) {
    throw InputError(path + ": cannot be opened (" + std::strerror(errno) +
                     ")");
  }
  const auto start = std::chrono::steady_clock::now();
  while (flock(file, kind | LOCK_NB) != 0) {
    const int error = errno;
    if (error == EINTR) continue;
    if (error == EWOULDBLOCK &&
        std::chrono::steady_clock::now() - start < kPatience) {
      std::this_thread::sleep_for(kRetryEvery);
      continue;
    }
    close(file);
    if (error != EWOULDBLOCK) {
      throw InputError(path + ": cannot be locked (" + std::strerror(error) +
                       ")");
    }
    throw InputError(path +
                     ": locked by another rgbd_batch that uses this folder; "
                     "wait for it or choose another --output");
  }
  return file;
}

}  // namespace

std::string BatchFolder::Complete(const BatchRun& run) const {
  return (fs::path(output_) / run.Name()).string();
}

std::string BatchFolder::Partial(const BatchRun& run) const {
  return Complete(run) + kPartial;
}

std::optional<RunEnd> BatchFolder::ReadEnd(const BatchRun& run) const {
  if (!Holds(run)) return std::nullopt;
  const std::string path = (fs::path(Complete(run)) / kMarker).string();
  const auto json = nlohmann::json::parse(ReadTextFile(path), nullptr, false);
  try {
    if (!json.at("exit_code").is_number_integer()) return std::nullopt;
    const RunEnd end = {json.at("status"), json.at("exit_code"),
                        json.at("hash")};
    const bool has_results =
        end.exit_code != 0 || IsFile(fs::path(Complete(run)) / "metrics.json");
    if (end.hash == run.hash && IsStatus(end.status) && has_results) return end;
  } catch (const nlohmann::json::exception&) {
    // from another program
  }
  return std::nullopt;
}

bool BatchFolder::Holds(const BatchRun& run) const {
  return IsFile(fs::path(Complete(run)) / kMarker);
}

std::string BatchFolder::FindRun(const std::string& sequence) const {
  const std::vector<fs::path> sequences =
      sequence.empty() ? FoldersIn(output_)
                       : std::vector<fs::path>{fs::path(output_) / sequence};
  for (const fs::path& folder : sequences) {
    for (const fs::path& run : FoldersIn(folder)) {
      std::error_code error;
      if (run.extension() == kPartial || fs::exists(run / kMarker, error)) {
        return run.string();
      }
    }
  }
  return "";
}

void BatchFolder::Begin(const BatchRun& run) const {
  const std::string folder = Partial(run);
  std::error_code error;
  fs::remove_all(folder, error);
  Check(error, folder);
  fs::create_directories(folder, error);
  Check(error, folder);
}

void BatchFolder::Finish(const BatchRun& run, const RunEnd& end) const {
  const nlohmann::ordered_json json = {
      {"status", end.status}, {"exit_code", end.exit_code}, {"hash", end.hash}};
  WriteFileAtomically((fs::path(Partial(run)) / kMarker).string(),
                      json.dump(2) + "\n");
  std::error_code error;
  fs::remove_all(Complete(run), error);
  Check(error, Complete(run));
  fs::rename(Partial(run), Complete(run), error);
  Check(error, Complete(run));
}

BatchLock::BatchLock(const std::string& output, const BatchShard& shard)
    : folder_file_(
          Lock(output + "/.lock", shard.IsWhole() ? LOCK_EX : LOCK_SH)) {
  if (shard.IsWhole()) return;
  try {
    shard_file_ = Lock(output + "/.lock-" + shard.Name(), LOCK_EX);
  } catch (const InputError&) {
    close(folder_file_);
    throw;
  }
}

BatchLock::~BatchLock() {
  if (shard_file_ >= 0) close(shard_file_);
  close(folder_file_);
}

}  // namespace rgbd_pose
