#include "app/view/model/folder_listing.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include "app/base/text.h"
#include "app/library/find/program_finder.h"
#include "app/setup/autodesk_machine.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/job_thread.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "core/base/text.h"

namespace app::viewer {
namespace {

/// TOML files of a folder that are read to tell machines from set-ups, and bytes of each.
constexpr size_t most_read = 500, read_bytes = 16'384;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The number at a position, without leading zeros; moves behind it.
std::string_view number_at(const std::string& text, size_t& at) {
    while (at < text.size() && text[at] == '0') ++at;
    const size_t first = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    return std::string_view(text).substr(first, at - first);
}

std::string ending_of_name(const std::string& name) {
    const size_t dot = name.rfind('.');
    return dot == std::string::npos || dot == 0 ? std::string() : name.substr(dot);
}

bool is_hidden_name(const std::string& name) { return name.starts_with('.'); }

/// Lists one folder.
class FolderReader {
public:
    FolderReader(const std::string& folder, const std::function<bool()>& is_over)
        : folder_(folder), is_over_(is_over) {}

    void run(const std::function<void(std::shared_ptr<const FolderListing>)>& publish);

private:
    using Clock = std::chrono::steady_clock;

    FolderEntry entry_of(std::string name);
    /// The listing so far, in order.
    std::shared_ptr<const FolderListing> listing(bool is_whole) const;

    const std::string& folder_;
    const std::function<bool()>& is_over_;
    FolderListing found_;
    size_t read_ = 0; // TOML files
};

FolderEntry FolderReader::entry_of(std::string name) {
    FolderEntry entry;
    const std::filesystem::path path = std::filesystem::path(folder_) / name;
    entry.name = std::move(name);
    entry.shown = readable_name(entry.name);
    entry.key = core::lower_case(entry.shown);
    entry.is_hidden = is_hidden_name(entry.name);
    const auto facts = core::platform::facts_of(path);
    entry.is_broken = !facts;
    entry.kind = facts && facts->is_folder ? FileKind::folder : kind_by_name(entry.shown);
    if (!facts) return entry;
    entry.size = facts->size;
    entry.modified = facts->modified;
    const bool is_toml = entry.kind == FileKind::setup && facts->is_file;
    if (is_toml && read_++ < most_read
        && is_machine_text(core::file_bytes(path, read_bytes).value_or("")))
        entry.kind = FileKind::machine;
    return entry;
}

std::shared_ptr<const FolderListing> FolderReader::listing(bool is_whole) const {
    auto ordered = std::make_shared<FolderListing>(found_);
    ordered->is_whole = is_whole;
    std::sort(ordered->entries.begin(), ordered->entries.end(),
              [](const FolderEntry& a, const FolderEntry& b) {
                  const bool a_file = a.kind != FileKind::folder,
                             b_file = b.kind != FileKind::folder;
                  return a_file != b_file ? b_file : is_before(a.key, b.key);
              });
    return ordered;
}

void FolderReader::run(const std::function<void(std::shared_ptr<const FolderListing>)>& publish) {
    found_.folder = folder_;
    const auto facts = core::platform::facts_of(folder_);
    found_.modified = facts ? facts->modified : 0;
    std::error_code failure;
    std::vector<std::string> names = core::platform::names_in(folder_, failure);
    if (failure) {
        found_.error = !facts ? "there is no such file or folder" : failure.message();
        return publish(listing(true));
    }
    found_.is_cut = names.size() > most_entries;
    names.resize(std::min(names.size(), most_entries));
    auto pause = std::chrono::milliseconds(150);
    auto next = Clock::now() + pause;
    for (std::string& name : names) {
        if (is_over_()) return;
        found_.entries.push_back(entry_of(std::move(name)));
        if (Clock::now() < next) continue;
        publish(listing(false));
        pause *= 2;
        next = Clock::now() + pause;
    }
    publish(listing(true));
}

} // namespace

std::string readable_name(const std::string& name) {
    std::string shown = printable(name);
    std::replace(shown.begin(), shown.end(), '\n', ' ');
    return shown;
}

FileKind kind_by_name(const std::string& path) {
    if (is_mesh_file(path)) return FileKind::mesh;
    if (is_tool_library(path)) return FileKind::tools;
    if (core::lower_case(path).ends_with(".html")) return FileKind::page;
    if (is_setup_file(path)) return FileKind::setup;
    if (is_autodesk_machine(path) || core::lower_case(ending_of_name(path)) == ".ini")
        return FileKind::machine;
    return foreign_kind(path).empty() ? FileKind::program : FileKind::other;
}

bool is_machine_text(const std::string& text) {
    return text.starts_with("[[axis]]") || text.find("\n[[axis]]") != std::string::npos;
}

bool is_before(const std::string& a, const std::string& b) {
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view left = number_at(a, i), right = number_at(b, j);
            if (left.size() != right.size()) return left.size() < right.size();
            if (left != right) return left < right;
        } else if (a[i] != b[j]) {
            return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
        } else {
            ++i;
            ++j;
        }
    }
    if (i < a.size() || j < b.size()) return j < b.size();
    return a < b; // they differ in leading zeros at most
}

void list_folder(const std::string& folder, const std::function<bool()>& is_over,
                 const std::function<void(std::shared_ptr<const FolderListing>)>& publish) {
    FolderReader(folder, is_over).run(publish);
}

class FolderWorker::Thread {
public:
    explicit Thread(std::function<void()> wake)
        : jobs_(std::move(wake), [this](const FolderJob& job, uint64_t run) { look(job, run); }) {}

    uint64_t start(FolderJob job) { return jobs_.start(std::move(job)); }
    FolderUpdate take() { return jobs_.take(); }

private:
    void look(const FolderJob& job, uint64_t run);
    void look_at_path(const FolderJob& job, uint64_t run);
    void deliver(FolderUpdate news);

    JobThread<FolderJob, FolderUpdate> jobs_;
};

void FolderWorker::Thread::deliver(FolderUpdate news) {
    jobs_.deliver(std::move(news), [](FolderUpdate& fresh, FolderUpdate& untaken) {
        if (!fresh.listing) fresh.listing = std::move(untaken.listing);
        fresh.is_file = fresh.is_file || untaken.is_file;
    });
}

void FolderWorker::Thread::look_at_path(const FolderJob& job, uint64_t run) {
    const auto facts = core::platform::facts_of(job.path);
    if (facts && !facts->is_folder) return deliver({.run = run, .listing = {}, .is_file = true});
    if (facts && job.known == facts->modified) return;
    list_folder(
        job.path, [&] { return jobs_.is_over(run); },
        [&](std::shared_ptr<const FolderListing> listing) {
            deliver({.run = run, .listing = std::move(listing)});
        });
}

void FolderWorker::Thread::look(const FolderJob& job, uint64_t run) {
    if (!job.path.empty()) look_at_path(job, run);
    std::set<std::string> missing;
    for (const std::string& file : job.files) {
        if (jobs_.is_over(run)) return;
        if (!core::is_file(file)) missing.insert(file);
    }
    deliver({.run = run, .listing = {}, .missing_files = std::move(missing)});
}

FolderWorker::FolderWorker(std::function<void()> wake)
    : thread_(std::make_unique<Thread>(std::move(wake))) {}

FolderWorker::~FolderWorker() = default;

uint64_t FolderWorker::start(FolderJob job) { return thread_->start(std::move(job)); }

FolderUpdate FolderWorker::take() { return thread_->take(); }

} // namespace app::viewer
