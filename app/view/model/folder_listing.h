#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace app::viewer {

/// What a file is, mostly by its extension.
enum class FileKind : uint8_t { folder, program, setup, machine, mesh, tools, page, other };

/// A file or folder as the browser lists it.
struct FolderEntry {
    std::string name;  // as the system has it
    std::string shown; // readable, UTF-8
    std::string key;   // `shown` in lower case, for filters and the order
    FileKind kind{};
    bool is_broken = false; // a link that leads nowhere, or unreadable
    bool is_hidden = false;
    uint64_t size = 0;    // bytes
    int64_t modified = 0; // nanoseconds since 1970
};

/// The contents of a folder. Never changes.
struct FolderListing {
    std::string folder;               // path
    std::vector<FolderEntry> entries; // folders first, each group by name
    std::string error;                // why the folder cannot be listed; empty: it can
    int64_t modified = 0;             // of the folder, nanoseconds since 1970
    bool is_whole = true;             // false: more is still being read
    bool is_cut = false;              // it has more than `most_entries`
};

constexpr size_t most_entries = 500'000;

/// A name as text in one line: UTF-8, without control characters.
std::string readable_name(const std::string& name);

/// The kind of a file by its extension; set-ups and machines in TOML are both `setup`.
FileKind kind_by_name(const std::string& path);

/// Whether the text at the beginning of a TOML file is that of a machine.
bool is_machine_text(const std::string& text);

/// Whether `a` comes before `b` in a list; numbers count as numbers: "part 2" before "part 10".
bool is_before(const std::string& a, const std::string& b);

/// Lists a folder. `publish` gets parts of a large one, in growing intervals, and the whole.
/// Ends early once `is_over`.
void list_folder(const std::string& folder, const std::function<bool()>& is_over,
                 const std::function<void(std::shared_ptr<const FolderListing>)>& publish);

/// A path to look at.
struct FolderJob {
    std::string path; // absolute; empty: none
    // Modification time of the folder as listed before: it is only listed again if it has changed.
    std::optional<int64_t> known = {};
    std::vector<std::string> files = {}; // whether they exist is wanted too
};

/// What was found.
struct FolderUpdate {
    uint64_t run = 0; // number of the job
    std::shared_ptr<const FolderListing> listing;
    bool is_file = false;                                    // the path is that of a file
    std::optional<std::set<std::string>> missing_files = {}; // of the job
    bool has_news = false;
};

/// Looks at folders in a separate thread, always at the last one requested: a slow drive delays no
/// frame.
class FolderWorker {
public:
    /// `wake` is called from the thread whenever there is an update.
    explicit FolderWorker(std::function<void()> wake);
    ~FolderWorker();

    /// Starts a job instead of the current one. Returns its number, above 0.
    uint64_t start(FolderJob job);
    /// Everything new since the last call.
    FolderUpdate take();

private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

} // namespace app::viewer
