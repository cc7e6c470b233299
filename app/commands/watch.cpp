#include "app/commands/watch.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/ranges.h>

#include "app/batch/watch_pace.h"
#include "app/commands/output.h"
#include "app/commands/pass_outputs.h"
#include "app/commands/progress.h"
#include "app/report/text_layout.h"

namespace app {
namespace {

using Clock = WatchPace::Clock;
using namespace std::chrono_literals;

void wait(Clock::duration duration) {
    const Clock::time_point end = Clock::now() + duration;
    while (!is_interrupted() && Clock::now() < end)
        std::this_thread::sleep_for(std::min<Clock::duration>(50ms, end - Clock::now()));
}

/// What has changed, once it is to be checked; empty after Ctrl-C.
std::vector<std::string> wait_for_change(WatchedFiles& files) {
    WatchPace pace(Clock::now());
    while (true) {
        wait(pace.pause());
        if (is_interrupted()) return {};
        const Clock::time_point begin = Clock::now();
        WatchedFiles::Change change = files.look_again();
        if (pace.is_time(change, begin, Clock::now() - begin)) return std::move(change.paths);
    }
}

std::string name_of(const std::string& place) {
    const std::filesystem::path path(place);
    return (path.has_filename() ? path.filename() : path).string();
}

/// Their names, with the folder where two would be called the same.
std::string names_of(const std::vector<std::string>& paths) {
    constexpr size_t most = 3;
    std::map<std::string, size_t> counts;
    for (const std::string& path : paths) ++counts[name_of(path)];
    std::vector<std::string> names;
    for (size_t i = 0; i < std::min(paths.size(), most); ++i) {
        const std::string name = name_of(paths[i]);
        names.push_back(counts[name] > 1 ? paths[i] : name);
    }
    std::string text = fmt::format("{}", fmt::join(names, ", "));
    if (paths.size() > most) text += fmt::format(" and {} more", paths.size() - most);
    return text;
}

void say(const std::string& text) {
    std::fflush(stdout);
    print_note(text);
}

} // namespace

ExitCode watch(const std::vector<std::string>& outputs,
               const std::function<ExitCode(WatchedFiles&)>& pass) {
    stop_on_interrupt();
    WatchedFiles files(outputs);
    PassOutputs written(outputs);
    while (true) {
        files.begin_again();
        written.begin_pass();
        ExitCode code{};
        {
            const core::FileListening listening(
                [&files](const core::FileLook& look) { files.note(look); });
            code = pass(files);
        }
        written.end_pass(files);
        if (is_interrupted()) return code;
        say(fmt::format("feeler: watching {}; Ctrl-C ends it\n", counted(files.size(), "place")));
        const std::vector<std::string> changed = wait_for_change(files);
        if (changed.empty()) return code;
        const std::time_t now = std::time(nullptr);
        say(fmt::format("\nfeeler: {:%H:%M:%S} {} changed\n", fmt::localtime(now),
                        names_of(changed)));
    }
}

} // namespace app
