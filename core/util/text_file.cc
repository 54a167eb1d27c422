#include "core/util/text_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <system_error>

#include "core/util/input_error.h"
#include "core/util/open_file.h"

namespace rgbd_pose {
namespace {

std::vector<std::string> SplitWords(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,\r";
  std::vector<std::string> words;
  for (size_t end = 0;;) {
    const size_t begin = line.find_first_not_of(kSeparators, end);
    if (begin == std::string_view::npos) return words;
    end = std::min(line.find_first_of(kSeparators, begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
  }
}

void RefuseFolder(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, but a file is expected");
  }
}

// Renaming would replace a device, such as /dev/null, by a file.
void RefuseDevice(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_other(path, error)) {
    throw InputError(path + ": is a device or a pipe, but a file is expected");
  }
}

// The file that is renamed when it is complete. One writer at a time has it;
// others wait.
class TemporaryFile {
 public:
  // Throws InputError if it cannot be created.
  explicit TemporaryFile(const std::string& path) : path_(TemporaryPath(path)) {
    RefuseDevice(path);
    do {
      if (file_ >= 0) close(file_);
      file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
      if (file_ < 0) {
        throw InputError(path + ": cannot be written " + LastFailure() +
                         "; check that its folder exists and is writable");
      }
      // File systems without locks are accepted.
      while (flock(file_, LOCK_EX) != 0 && errno == EINTR) {
      }
    } while (!IsAt(file_, path_));  // it was renamed or removed meanwhile
  }
  ~TemporaryFile() { close(file_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  // The following return false on failure, as errno says.
  bool Write(std::string_view content) const {
    if (ftruncate(file_, 0) != 0) return false;
    while (!content.empty()) {
      const ssize_t written = write(file_, content.data(), content.size());
      if (written < 0 && errno != EINTR) return false;
      content.remove_prefix(std::max<ssize_t>(written, 0));
    }
    // Some network file systems tell only now; the lock stays.
    return close(dup(file_)) == 0;
  }
  bool Sync() const { return fsync(file_) == 0; }
  bool MoveTo(const std::string& path) const {
    return std::rename(path_.c_str(), path.c_str()) == 0;
  }
  void Remove() const { std::remove(path_.c_str()); }

 private:
  const std::string path_;
  int file_ = -1;
};

}  // namespace

std::string LastFailure() {
  return "(" + std::generic_category().message(errno) + ")";
}

bool PathExists(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

bool IsFile(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::string ReadTextFile(const std::string& path) {
  RefuseFolder(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path +
                     ": cannot be opened; check the path and permissions");
  }
  std::string content;
  char buffer[1 << 16];
  do {
    file.read(buffer, sizeof(buffer));
    content.append(buffer, file.gcount());
  } while (file);
  if (file.bad()) throw InputError(path + ": cannot be read");
  return content;
}

std::vector<TextLine> ReadTextTable(const std::string& path) {
  const std::string content = ReadTextFile(path);
  // Tools of Windows write it, such as PowerShell's redirection.
  const std::string start = content.substr(0, 2);
  if (start == "\xFF\xFE" || start == "\xFE\xFF") {
    throw InputError(path + ": is text in UTF-16; save it as UTF-8");
  }
  return SplitTextTable(content);
}

std::vector<TextLine> SplitTextTable(std::string_view content) {
  std::string_view rest = WithoutByteOrderMark(content);
  std::vector<TextLine> lines;
  for (int number = 1; !rest.empty(); ++number) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = line.substr(0, line.find('#'));
    std::vector<std::string> words = SplitWords(line);
    if (!words.empty()) lines.push_back({number, std::move(words)});
  }
  return lines;
}

std::string_view WithoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    text.remove_prefix(kByteOrderMark.size());
  }
  return text;
}

std::vector<std::string> SplitText(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0;;) {
    const size_t end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::vector<std::string> SplitList(std::string_view text, char separator) {
  std::vector<std::string> parts = SplitText(text, separator);
  for (std::string& part : parts) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
  }
  return parts;
}

std::string Join(const std::vector<std::string>& names, const char* separator) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : separator) + name;
  }
  return text;
}

double ParseNumber(std::string_view word, const std::string& path, int line,
                   std::string_view what) {
  // from_chars takes no leading '+', which some writers print.
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() ||
      !std::isfinite(value)) {
    throw InputError(path, line,
                     "'" + std::string(word) + "' is not a finite number for " +
                         std::string(what));
  }
  return value;
}

std::optional<int> ParseWhole(std::string_view text) {
  int value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) {
    return std::nullopt;
  }
  return value;
}

double ParseTimestamp(std::string_view word, const std::string& path,
                      int line) {
  constexpr double kLatest = 1e11;  // in the year 5138
  const double seconds = ParseNumber(word, path, line, "the time stamp");
  if (std::abs(seconds) > kLatest) {
    throw InputError(path, line,
                     "time stamp " + std::string(word) +
                         " is not in seconds; are these milli- or "
                         "nanoseconds?");
  }
  return seconds;
}

std::string TemporaryPath(const std::string& path) { return path + ".partial"; }

void WriteFileAtomically(const std::string& path, std::string_view content,
                         Durability durability) {
  const TemporaryFile file(path);
  if (file.Write(content) &&
      (durability == Durability::kCrash || file.Sync()) && file.MoveTo(path)) {
    return;
  }
  const std::string reason = LastFailure();
  file.Remove();
  throw InputError(path + ": writing failed " + reason);
}

void SyncFolder(const std::string& path) {
  const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some network file systems persist names by themselves and return EINVAL.
  const bool is_done = folder >= 0 && (fsync(folder) == 0 || errno == EINVAL);
  const std::string reason = is_done ? "" : LastFailure();
  if (folder >= 0) close(folder);
  if (!is_done) throw InputError(path + ": cannot be synchronised " + reason);
}

void RequireWritable(const std::string& path) {
  RefuseFolder(path);
  TemporaryFile(path).Remove();
}

}  // namespace rgbd_pose
