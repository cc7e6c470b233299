#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/ui/window.h"
#include "core/base/file_reads.h"

namespace app::viewer {

bool is_part_of_setup(const std::string& path) {
    return is_mesh_file(path) || is_tool_library(path) || is_machine_file(path);
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

std::optional<CheckJob> with_dropped(CheckJob check, const std::vector<std::string>& paths,
                                     ViewModel& model, double now) {
    const std::string before = check.program;
    bool has_program = false, has_setup = false;
    for (const std::string& path : paths) {
        if (is_part_of_setup(path)) {
            if (model.program && add_file(model, path))
                show_setup(model, true);
            else
                say(model, "Open a program first: then the file is added to its set-up", now);
        } else if (is_setup_file(path)) {
            check.setup = path;
            has_setup = true;
        } else {
            check.program = path;
            has_program = true;
        }
    }
    if (!has_program && !has_setup) return {};
    if (check.program.empty()) {
        say(model, "Drop a program as well", now);
        return {};
    }
    if (has_program && !has_setup) check.setup.clear();
    if (check.program != before) {
        model.opens_another = true;
    }
    check.setup_text.reset();
    return check;
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
