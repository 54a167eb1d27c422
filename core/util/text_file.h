#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// One data line of a text table: what is left after comments are taken out.
struct TextLine {
  int number = 0;  // 1-based, for messages
  std::vector<std::string> words;
};

// The data lines of a text file with columns set apart by white space or
// commas: comments ('#' to the end of the line), empty lines, carriage returns
// and a byte order mark are taken out. Throws InputError if it cannot be read.
std::vector<TextLine> ReadTextTable(const std::string& path);

// The same of a file's content.
std::vector<TextLine> SplitTextTable(std::string_view content);

// A text without the byte order mark that some editors put before it.
std::string_view WithoutByteOrderMark(std::string_view text);

// The parts of a text between separators; one at least, which may be empty.
std::vector<std::string> SplitText(std::string_view text, char separator);

// Names as a list for a message: "a, b, c".
std::string Join(const std::vector<std::string>& names);

// A finite number, the whole word, independent of the locale; throws
// InputError naming file, line and `what` otherwise.
double ParseNumber(std::string_view word, const std::string& path, int line,
                   std::string_view what);

// A time stamp in seconds: as ParseNumber, and no number of milli- or
// nanoseconds since 1970.
double ParseTimestamp(std::string_view word, const std::string& path, int line);

// Whether there is a file or folder of that name; no, too, if that cannot be
// found out.
bool PathExists(const std::filesystem::path& path);

// The whole content of a file. Throws InputError if it cannot be read.
std::string ReadTextFile(const std::string& path);

// What a file that is being written survives: the old one or the new is there.
enum class Durability {
  kCrash,      // of the program
  kPowerLoss,  // too: its bytes are on the disk before it takes its name
};

// Writes a file as a whole or not at all: first to TemporaryPath, then renamed.
// Throws InputError if it cannot (folder missing, disk full).
void WriteFileAtomically(const std::string& path, std::string_view content,
                         Durability durability = Durability::kCrash);

// Where WriteFileAtomically writes a file until it is whole.
std::string TemporaryPath(const std::string& path);

// Has the names in a folder on the disk, new, changed and removed ones. Throws
// InputError if it cannot.
void SyncFolder(const std::string& path);

// Throws InputError if WriteFileAtomically could not write the file: to be said
// before the work rather than after it. Leaves everything as it was.
void RequireWritable(const std::string& path);

}  // namespace rgbd_pose
