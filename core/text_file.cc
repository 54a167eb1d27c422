#include "core/text_file.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/input_error.h"

namespace rgbd_pose {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool IsSeparator(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == '\r';
}

std::vector<std::string> SplitWords(std::string_view line) {
  std::vector<std::string> words;
  size_t begin = 0;
  while (begin < line.size()) {
    if (IsSeparator(line[begin])) {
      ++begin;
      continue;
    }
    size_t end = begin;
    while (end < line.size() && !IsSeparator(line[end])) ++end;
    words.emplace_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

// What is written aside until it is whole.
std::string AsideOf(const std::string& path) { return path + ".partial"; }

std::FILE* OpenToWrite(const std::string& path) {
  std::FILE* file = std::fopen(AsideOf(path).c_str(), "wb");
  if (file == nullptr) {
    throw InputError(path +
                     ": cannot be written; check that its folder exists and "
                     "may be written to");
  }
  return file;
}

}  // namespace

std::string ReadTextFile(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, a file is needed here");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path +
                     ": cannot be opened; check the path and its rights");
  }
  std::ostringstream content;
  content << file.rdbuf();
  if (file.bad()) throw InputError(path + ": cannot be read");
  return content.str();
}

std::vector<TextLine> ReadTextTable(const std::string& path) {
  std::string content = ReadTextFile(path);
  std::string_view rest = content;
  if (rest.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    rest.remove_prefix(kByteOrderMark.size());
  }
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

std::string Join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
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
                     "'" + std::string(word) + "' is no finite number for " +
                         std::string(what));
  }
  return value;
}

void WriteFileAtomically(const std::string& path, std::string_view content) {
  const std::string aside = AsideOf(path);
  std::FILE* file = OpenToWrite(path);
  const bool written =
      std::fwrite(content.data(), 1, content.size(), file) == content.size();
  const bool closed = std::fclose(file) == 0;
  std::error_code error;
  if (written && closed) std::filesystem::rename(aside, path, error);
  if (!written || !closed || error) {
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw InputError(path + ": writing failed; is the disk full?");
  }
}

void RequireWritable(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path + ": is a folder, a file is needed here");
  }
  std::fclose(OpenToWrite(path));
  std::filesystem::remove(AsideOf(path), ignored);
}

}  // namespace rgbd_pose
