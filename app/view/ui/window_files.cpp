#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/ui/window.h"
#include "core/base/file_reads.h"

namespace app::viewer {
namespace {

/// The set-up of the same name as the program, or the only one; empty: none.
std::string setup_for(const std::string& program, const std::vector<std::string>& setups) {
    const auto name = std::filesystem::path(program).stem();
    for (const std::string& setup : setups)
        if (std::filesystem::path(setup).stem() == name) return setup;
    return setups.size() == 1 ? setups.front() : std::string();
}

} // namespace

bool is_part_of_setup(const std::string& path) {
    return is_mesh_file(path) || is_tool_library(path) || is_machine_file(path) || is_ini_file(path)
           || is_cam_job(path) || is_offset_file(path);
}

bool can_open(const std::vector<std::string>& paths, ViewModel& model, double now) {
    for (const std::string& path : paths) {
        if (core::is_folder(path)) {
            browse_here(model, FileWish::open, path);
            return false;
        }
        const std::string why = core::why_no_file(path);
        if (why.empty()) continue;
        say(model, fmt::format("{}: {}", readable_name(path), why), now);
        return false;
    }
    return true;
}

std::vector<CheckJob> dropped_programs(CheckJob check, const std::vector<std::string>& paths,
                                       ViewModel& model, double now) {
    std::vector<std::string> programs, setups;
    for (const std::string& path : paths) {
        if (!is_part_of_setup(path))
            (is_setup_file(path) ? setups : programs).push_back(path);
        else if (model.program && add_file(model, path))
            show_setup(model, true);
        else
            say(model, "Open a program first: then the file is added to its set-up", now);
    }
    check.setup_text.reset();
    if (programs.empty() && !setups.empty()) {
        if (check.program.empty()) say(model, "Drop a program as well", now);
        if (check.program.empty()) return {};
        check.setup = setups.back();
        check.setup_was_found = false;
        return {check};
    }
    std::vector<CheckJob> jobs;
    for (const std::string& program : programs) {
        check.program = program;
        check.setup = setup_for(program, setups);
        check.setup_was_found = false;
        find_setup_next_to(check); // as all commands do
        jobs.push_back(check);
    }
    return jobs;
}

void keep_notes(ViewModel& model, const std::filesystem::path& path, const FileWriter& write,
                double now) {
    if (path.empty() || !model.program) return;
    std::error_code ignored; // writing the file reports it
    std::filesystem::create_directories(path.parent_path(), ignored);
    model.notes =
        merged(notes_in(core::file_bytes(path).value_or("")), model.notes, notes_key(model));
    const auto written = write(path.generic_string(), text_of(model.notes));
    if (!written) say(model, "The comment could not be saved: " + written.error().message, now);
}

} // namespace app::viewer
