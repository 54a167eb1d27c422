#include "core/util/input_error.h"
#include "frontend/bags/bag_reader.h"
#ifdef RGBD_POSE_HAS_SQLITE
#include <sqlite3.h>

#include <filesystem>

#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/bags/chunk_codec.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_SQLITE

namespace {

// A query whose rows are read one after the other.
class Rows {
 public:
  Rows(const std::string& path, sqlite3* database, const std::string& query)
      : path_(path), database_(database) {
    const int status =
        sqlite3_prepare_v2(database, query.c_str(), -1, &statement_, nullptr);
    if (status != SQLITE_OK) Fail();
  }
  ~Rows() { sqlite3_finalize(statement_); }
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  // Goes to the next row; false if there is none.
  bool Next() {
    const int status = sqlite3_step(statement_);
    if (status == SQLITE_ROW) return true;
    if (status != SQLITE_DONE) Fail();
    return false;
  }
  int64_t Number(int column) {
    return sqlite3_column_int64(statement_, column);
  }
  std::string Bytes(int column) {
    // sqlite3 requires this order of the two calls.
    const void* bytes = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    if (bytes == nullptr) {
      if (sqlite3_errcode(database_) == SQLITE_NOMEM) Fail();
      return "";
    }
    return {static_cast<const char*>(bytes), static_cast<size_t>(size)};
  }

 private:
  [[noreturn]] void Fail() {
    const int code = sqlite3_errcode(database_);
    if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY) {
      throw InputError(path_ + ": cannot be merged with the log " + path_ +
                       "-wal (" + sqlite3_errmsg(database_) +
                       "); copy both to a writable folder");
    }
    throw InputError(path_ + ": cannot be read as a ROS 2 bag: " +
                     sqlite3_errmsg(database_) +
                     "; it is damaged or cut off: copy it again");
  }

  const std::string& path_;
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
};

// The URI by which a database is opened. Unless a recorder left a log, which
// only sqlite3 can merge, it is marked immutable: otherwise sqlite3 writes
// files next to it, which fails in a read-only folder.
std::string UriOf(const std::string& path) {
  std::string uri = path.front() == '/' ? "file://" : "file:";
  for (const char c : path) {
    const bool is_special = c == '%' || c == '?' || c == '#';
    uri += is_special ? Format("%%%02x", c) : std::string(1, c);
  }
  for (const char* log : {"-wal", "-journal"}) {
    std::error_code error;
    if (std::filesystem::file_size(path + log, error) > 0 && !error) return uri;
  }
  return uri + "?immutable=1";
}

class BagDatabase final : public BagReader {
 public:
  explicit BagDatabase(const std::string& path)
      : BagReader(path, WireFormat::kCdr) {
    std::error_code error;
    if (std::filesystem::file_size(path, error) == 0 && !error) {
      throw InputError(path + ": is empty; copy it again");
    }
    sqlite3* database = nullptr;
    const int status =
        sqlite3_open_v2(UriOf(path).c_str(), &database,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (status != SQLITE_OK) {
      throw InputError(
          path + ": cannot be opened: " + sqlite3_errmsg(database_.get()));
    }
    Rows rows(path_, database_.get(),
              "SELECT id, name, type, serialization_format FROM topics "
              "ORDER BY id");
    while (rows.Next()) {
      if (rows.Bytes(3) != "cdr") continue;  // unknown format
      AddTopic(rows.Number(0), rows.Bytes(1), rows.Bytes(2));
    }
    // Sorting by time without an index would sort whole rows with their data.
    Rows index(path_, database_.get(), "PRAGMA index_list(messages)");
    order_ = index.Next() ? " ORDER BY timestamp, id" : " ORDER BY id";
  }

  Messages MessagesOf(const std::vector<std::string>& topics) override {
    std::vector<std::string> ids;
    for (const int64_t id : NumbersOf(topics)) {
      ids.push_back(std::to_string(id));
    }
    // The plus makes sqlite3 go through the messages by time, not by topic.
    const auto rows = std::make_shared<Rows>(
        path_, database_.get(),
        "SELECT topic_id, timestamp, data FROM messages WHERE +topic_id IN (" +
            Join(ids) + ")" + order_);
    return [this, rows]() -> std::optional<BagMessage> {
      if (!rows->Next()) return std::nullopt;
      std::string bytes = rows->Bytes(2);
      const auto unpack = [&] { return UnpackMessage(std::move(bytes)); };
      return BagMessage{names_.at(rows->Number(0)),
                        static_cast<double>(rows->Number(1)) * 1e-9,
                        std::make_shared<std::string>(
                            Located(path_ + ": a message", unpack))};
    };
  }

 private:
  // Closed once its last query has ended.
  std::unique_ptr<sqlite3, decltype(&sqlite3_close_v2)> database_ = {
      nullptr, sqlite3_close_v2};
  std::string order_;
};

}  // namespace

std::unique_ptr<BagReader> OpenBagDatabase(const std::string& path) {
  return std::make_unique<BagDatabase>(path);
}

#else

std::unique_ptr<BagReader> OpenBagDatabase(const std::string& path) {
  throw InputError(path +
                   ": this build cannot read ROS 2 bags; install "
                   "libsqlite3-dev (scripts/install_dependencies formats) and "
                   "build again");
}

#endif

}  // namespace rgbd_pose
