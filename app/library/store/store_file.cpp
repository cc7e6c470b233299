#include "app/library/store/store_file.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/base/file_stamp.h"
#include "gcode/language/program_folder.h"

namespace app {
namespace {

constexpr int64_t application = 0x4665656C; // "Feel"
constexpr int64_t store_format = 2;

/// Results are never changed. Results with the same file accesses share the rows of these.
constexpr const char* tables = R"(
CREATE TABLE program(
    id INTEGER PRIMARY KEY,
    path TEXT NOT NULL UNIQUE -- relative to the folder that contains .feeler or the file
) STRICT;
CREATE TABLE result(
    id INTEGER PRIMARY KEY,
    program INTEGER NOT NULL REFERENCES program(id),
    key TEXT NOT NULL,        -- of the job: see result_key
    looks TEXT NOT NULL,      -- a digest of all file accesses
    setup TEXT NOT NULL,
    options TEXT NOT NULL,
    version TEXT NOT NULL,
    checked_at INTEGER NOT NULL, -- seconds since 1970
    value TEXT NOT NULL,      -- JSON of a ProgramResult
    seal TEXT NOT NULL,       -- a digest of key, looks and value
    UNIQUE(key, looks)
) STRICT;
CREATE INDEX result_of_program ON result(program, id);
CREATE TABLE look(
    id INTEGER PRIMARY KEY,
    question INTEGER NOT NULL,
    path TEXT NOT NULL,
    name TEXT NOT NULL,
    answer TEXT NOT NULL,     -- "=" and the answer; empty if there was none
    UNIQUE(question, path, name, answer)
) STRICT;
CREATE TABLE result_look(
    result INTEGER NOT NULL REFERENCES result(id) ON DELETE CASCADE,
    look INTEGER NOT NULL REFERENCES look(id),
    PRIMARY KEY(result, look)
) STRICT, WITHOUT ROWID;
CREATE INDEX look_of_result ON result_look(look);
)";

/// When a result of this database or one next to it was last confirmed as valid. Since format 2.
constexpr const char* seen_table = R"(
CREATE TABLE seen(
    key TEXT NOT NULL,
    looks TEXT NOT NULL,
    at INTEGER NOT NULL,      -- microseconds since 1970
    PRIMARY KEY(key, looks)
) STRICT, WITHOUT ROWID;
)";

/// A rollback journal, not a write-ahead log: that one needs memory shared by all processes that
/// have the database open, which a network disk does not offer. FULL: a stored result survives a
/// power cut, and is never stored in part.
constexpr const char* manners = "PRAGMA foreign_keys = ON;"
                                "PRAGMA trusted_schema = OFF;"
                                "PRAGMA journal_mode = TRUNCATE;"
                                "PRAGMA synchronous = FULL;";

core::Error store_error(const std::string& path, std::string why) {
    return {core::ErrorCode::unsupported, {}, std::move(why), path};
}

/// Creates the tables. If two processes find the file empty or old at the same time, one waits and
/// then finds the tables of the other.
core::Result<void> make_tables(Database& database) {
    FEELER_TRY(Transaction making, Transaction::begin(database));
    FEELER_TRY(const int64_t made, database.number("PRAGMA user_version"));
    std::string all = made == 0 ? tables : "";
    if (made < store_format) all += seen_table;
    all += fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", application,
                       store_format);
    if (auto done = database.run(all); !done) return done;
    return making.commit();
}

core::Result<void> settle(Database& database, const std::string& path, Database::Access access) {
    FEELER_TRY(const int64_t found, database.number("PRAGMA user_version"));
    FEELER_TRY(const int64_t whose, database.number("PRAGMA application_id"));
    FEELER_TRY(const int64_t content, database.number("SELECT count(*) FROM sqlite_schema"));
    if (content > 0 && whose != application)
        return tl::unexpected(store_error(path, "is a database of another program"));
    if (found > store_format)
        return tl::unexpected(store_error(
            path, fmt::format("was written by a newer version of Feeler (its format is {}, "
                              "this version supports {})",
                              found, store_format)));
    if (access == Database::Access::read_only) {
        if (found == store_format) return {};
        return tl::unexpected(store_error(path, "was written by an older version of Feeler"));
    }
    if (auto done = database.run(manners); !done) return tl::unexpected(std::move(done).error());
    return found == store_format ? core::Result<void>{} : make_tables(database);
}

/// The databases in a folder `.feeler`, sorted.
std::vector<std::string> stores_in(const std::filesystem::path& folder) {
    std::vector<std::string> stores;
    for (const std::string& name : gcode::names_in(folder.empty() ? "." : folder)) {
        std::error_code failure;
        if (name.starts_with("results") && name.ends_with(".db")
            && std::filesystem::is_regular_file(folder / name, failure))
            stores.push_back((folder / name).generic_string());
    }
    return stores;
}

} // namespace

std::string default_store_path(const std::string& folder, const std::optional<ShardId>& shard) {
    const std::string name =
        shard ? fmt::format("results-{}of{}.db", shard->i, shard->n) : "results.db";
    return (std::filesystem::path(folder.empty() ? "." : folder) / ".feeler" / name)
        .generic_string();
}

std::vector<std::string> sibling_stores(const std::string& path) {
    std::vector<std::string> stores = stores_in(std::filesystem::path(path).parent_path());
    std::erase(stores, path);
    return stores;
}

std::vector<std::string> stores_above(const std::string& program) {
    std::error_code failure;
    std::filesystem::path folder =
        whole_path(std::filesystem::absolute(program, failure).parent_path(), failure);
    while (!failure) {
        std::vector<std::string> stores = stores_in(folder / ".feeler");
        if (!stores.empty() || folder == folder.parent_path()) return stores;
        folder = folder.parent_path();
    }
    return {};
}

core::Result<Database> open_store_file(const std::string& path, Database::Access access,
                                       std::shared_ptr<RetryBudget> retries) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code failure; // opening the file will report it, too
    if (folder.filename() == ".feeler" && access == Database::Access::read_write)
        std::filesystem::create_directory(folder, failure);
    FEELER_TRY(Database database, Database::open(path, access, std::move(retries)));
    if (auto done = settle(database, path, access); !done)
        return tl::unexpected(std::move(done).error());
    return database;
}

} // namespace app
