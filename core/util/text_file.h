#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// One data line of a text table, without comments.
struct TextLine {
  int number = 0;                  // 1-based, for messages
  std::vector<std::string> words;  // its columns
};

// The lines of a file with columns separated by white space or commas, without
// comments ('#' to the end of the line), empty lines, carriage returns and a
// byte order mark. Throws InputError if it cannot be read, or is in UTF-16.
std::vector<TextLine> ReadTextTable(const std::string& path);

// The same for the content of a file.
std::vector<TextLine> SplitTextTable(std::string_view content);

// The text without the byte order mark that some editors put before it.
std::string_view WithoutByteOrderMark(std::string_view text);

// The parts of a text between separators: at least one, possibly empty.
std::vector<std::string> SplitText(std::string_view text, char separator);

// The same without spaces around the parts, as people write lists.
std::vector<std::string> SplitList(std::string_view text, char separator = ',');

// Names as a list for a message: "a, b, c".
std::string Join(const std::vector<std::string>& names,
                 const char* separator = ", ");

// A finite number that takes up the whole word, independent of the locale.
// Otherwise throws InputError with the file, the line and `what`.
double ParseNumber(std::string_view word, const std::string& path, int line,
                   std::string_view what);

// A whole number from 0 on that takes up the whole text; nothing otherwise.
std::optional<int> ParseWhole(std::string_view text);

// A time in seconds: as ParseNumber, but not milli- or nanoseconds since 1970.
double ParseTimestamp(std::string_view word, const std::string& path, int line);

// Why the last call of the system failed, as "(No space left on device)".
std::string LastFailure();

// Whether the file or folder exists; false, too, if this cannot be determined.
bool PathExists(const std::filesystem::path& path);

// Whether it is a file and no folder or device; false, too, if unknown.
bool IsFile(const std::filesystem::path& path);

// The whole content of a file. Throws InputError if it cannot be read.
std::string ReadTextFile(const std::string& path);

// What a file survives while it is written, with its old or its new content.
enum class Durability {
  kCrash,      // a crash of the program
  kPowerLoss,  // also a power loss: data are on disk before the renaming
};

// Writes a file completely or not at all: first to TemporaryPath, then renamed.
// Throws InputError on failure (folder missing, disk full).
void WriteFileAtomically(const std::string& path, std::string_view content,
                         Durability durability = Durability::kCrash);

// The path WriteFileAtomically writes to before it renames the file.
std::string TemporaryPath(const std::string& path);

// Flushes names in a folder to disk. Throws InputError on failure.
void SyncFolder(const std::string& path);

// Throws InputError if the file cannot be written, before a long computation.
void RequireWritable(const std::string& path);

}  // namespace rgbd_pose
