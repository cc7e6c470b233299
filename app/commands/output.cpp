#include "app/commands/output.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/library/watch/watched_files.h"
#include "app/report/text/text_report.h"
#include "core/base/platform.h"

namespace app {
namespace {

// The files that this process has written.
std::mutex written_guard;
std::map<std::string, FileStamp> written_stamps; // by path

tl::unexpected<core::Error> refused(const std::string& path, const std::string& why) {
    return tl::unexpected<core::Error>({core::ErrorCode::io, {}, why, path});
}

/// Whether nobody may write a file. It could still be replaced, which is not what its owner wants.
bool is_read_only(const std::filesystem::file_status& status) {
    using enum std::filesystem::perms;
    return (status.permissions() & (owner_write | group_write | others_write)) == none;
}

bool write_all(std::FILE* file, std::string_view text) {
    return std::fwrite(text.data(), 1, text.size(), file) == text.size();
}

tl::unexpected<core::Error> standard_output_failed() {
    return refused("standard output", "cannot be written");
}

} // namespace

struct OutputStream::State {
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };

    std::string path{};             // as given; empty: standard output
    std::filesystem::path target{}; // final path; empty: written in place
    std::string fresh{};            // the file that is being written
    std::unique_ptr<std::FILE, Close> file{};

    ~State() {
        file.reset();
        std::error_code ignored;
        if (!target.empty() && !fresh.empty()) std::filesystem::remove(fresh, ignored);
    }
    tl::unexpected<core::Error> failed() const {
        if (path.empty()) return standard_output_failed();
        return refused(path, target.empty() ? "could not be written completely"
                                            : "could not be written completely; the old file "
                                              "is unchanged");
    }
};

OutputStream::OutputStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputStream::OutputStream(OutputStream&&) noexcept = default;
OutputStream::~OutputStream() = default;

core::Result<OutputStream> OutputStream::open(const std::string& path) {
    auto state = std::make_unique<State>();
    if (path.empty()) return OutputStream(std::move(state));
    state->path = path;
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    const auto kind = status.type();
    const std::filesystem::path target = resolved_path(path);
    if (kind == std::filesystem::file_type::none || target.empty())
        return refused(path,
                       "cannot be written: "
                           + (failure ? failure.message() : "its location cannot be determined"));
    if (kind == std::filesystem::file_type::directory) return refused(path, "is a folder");
    if (kind == std::filesystem::file_type::regular && is_read_only(status))
        return refused(path, "is read-only: choose another file, or make it writable");
    const bool is_file = kind == std::filesystem::file_type::regular
                         || kind == std::filesystem::file_type::not_found;
    const bool replace = is_file && !core::platform::is_device(path);
    const std::string fresh =
        replace ? fmt::format("{}.{}.new", target.generic_string(), core::platform::process_id())
                : path;
    state->file.reset(core::platform::open_file(fresh, replace ? "wb+" : "wb"));
    if (!state->file) return refused(path, "cannot be written: no such folder, or no permission");
    state->fresh = fresh;
    if (replace) state->target = target;
    if (replace && kind == std::filesystem::file_type::regular)
        core::platform::take_permissions(fresh, target); // before anybody can read its contents
    return OutputStream(std::move(state));
}

core::Result<void> OutputStream::write(std::string_view text) {
    if (!write_all(state_->path.empty() ? stdout : state_->file.get(), text))
        return state_->failed();
    return {};
}

core::Result<void> OutputStream::finish() {
    State& state = *state_;
    std::FILE* const file = state.path.empty() ? stdout : state.file.get();
    if (std::fflush(file) != 0) return state.failed();
    if (state.target.empty()) return {};
    if (!core::platform::write_through(file)) return state.failed();
    state.file.reset();
    if (const auto failure = core::platform::replace_file(state.fresh, state.target))
        return refused(state.path, fmt::format("cannot be replaced: {}; the old file is unchanged",
                                               failure.message()));
    state.fresh.clear();
    const std::scoped_lock lock(written_guard);
    written_stamps[state.path] = stamp_of(state.path);
    return {};
}

FileStamp written_stamp(const std::string& path) {
    const std::scoped_lock lock(written_guard);
    const auto written = written_stamps.find(path);
    return written == written_stamps.end() ? FileStamp{} : written->second;
}

core::Result<void> OutputStream::give_up() {
    State& state = *state_;
    if (state.target.empty()) return finish();
    std::rewind(state.file.get());
    std::array<char, 65536> piece;
    while (const size_t count = std::fread(piece.data(), 1, piece.size(), state.file.get()))
        if (!write_all(stdout, {piece.data(), count})) return standard_output_failed();
    return std::fflush(stdout) == 0 ? core::Result<void>{} : standard_output_failed();
}

core::Result<void> check_output(const std::string& output,
                                std::initializer_list<std::string> read) {
    for (const std::string& input : read) {
        std::error_code ignored; // missing inputs are reported elsewhere
        if (output.empty() || !std::filesystem::is_regular_file(output, ignored)
            || !core::platform::is_same_file(output, input))
            continue;
        return tl::unexpected<core::Error>(
            {core::ErrorCode::invalid_value,
             {},
             "is an input and would be overwritten: choose another file for -o",
             output});
    }
    return {};
}

core::Result<void> write_output(const std::string& path, const std::string& text) {
    FEELER_TRY(OutputStream stream, OutputStream::open(path));
    if (auto written = stream.write(text); !written) return written;
    return stream.finish();
}

TerminalStyle terminal_style(std::FILE* stream) {
    constexpr double narrowest = 40.0, widest = 500.0;
    TerminalStyle style;
    if (!core::platform::is_terminal(stream)) return style;
    style.colour = core::platform::environment_variable("NO_COLOR").empty();
    double width = number_in(core::platform::environment_variable("COLUMNS")).value_or(0.0);
    if (const auto known = core::platform::terminal_width(stream); known && width <= 0.0)
        width = static_cast<double>(*known);
    if (width > 0.0) style.width = static_cast<size_t>(std::clamp(width, narrowest, widest));
    return style;
}

void print_error(const core::Error& error) {
    print_note(fmt::format("feeler: {}\n", error_text(error)));
}

ExitCode failed(const core::Error& error) {
    print_error(error);
    return ExitCode::failed;
}

void print_note(const std::string& text) {
    std::fputs(printable(text).c_str(), stderr);
    std::fflush(stderr);
}

namespace {

void take_away(const std::string& path) {
    std::error_code failure;
    const std::filesystem::path file = std::filesystem::canonical(path, failure); // follows links
    if (!failure) std::filesystem::remove(file, failure);
    if (failure)
        print_error({core::ErrorCode::io,
                     {},
                     "describes an earlier version and cannot be deleted: " + failure.message(),
                     path});
    else
        print_note(fmt::format("feeler: {}: described an earlier version; deleted\n", path));
}

} // namespace

WatchOutputs::WatchOutputs(const std::vector<std::string>& paths) {
    for (const std::string& path : paths)
        if (!path.empty()) outputs_.push_back({.path = path});
}

void WatchOutputs::begin_pass() {
    for (Output& output : outputs_) output.before = written_stamp(output.path);
}

void WatchOutputs::end_pass(const WatchedFiles& read) {
    for (const Output& output : outputs_) {
        const FileStamp written = written_stamp(output.path);
        const bool is_old = written.is_file && written == output.before;
        if (is_old && written == stamp_of(output.path) && !read.reads(output.path))
            take_away(output.path);
    }
}

} // namespace app
