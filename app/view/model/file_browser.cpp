#include "app/view/model/file_browser.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/setup_text.h"
#include "app/setup/toml_edit.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/model/samples.h"
#include "app/view/model/view_model.h"
#include "core/base/platform.h"
#include "core/base/text.h"

namespace app::viewer {
namespace {

namespace fs = std::filesystem;

constexpr double look_interval = 2.0; // seconds

bool passes(FileFilter filter, FileKind kind) {
    switch (filter) {
    case FileFilter::openable:
        return kind == FileKind::program || kind == FileKind::setup;
    case FileFilter::programs:
        return kind == FileKind::program;
    case FileFilter::setups:
        return kind == FileKind::setup;
    case FileFilter::machines:
        return kind == FileKind::machine;
    case FileFilter::meshes:
        return kind == FileKind::mesh;
    case FileFilter::tools:
        return kind == FileKind::tools;
    case FileFilter::pages:
        return kind == FileKind::page;
    case FileFilter::all:
        return true;
    }
    return true;
}

FileFilter filter_for(FileWish wish) {
    switch (wish) {
    case FileWish::open:
        return FileFilter::openable;
    case FileWish::mesh:
    case FileWish::stock:
    case FileWish::part:
        return FileFilter::meshes;
    case FileWish::tools:
        return FileFilter::tools;
    case FileWish::machine:
        return FileFilter::machines;
    case FileWish::job:
    case FileWish::offsets:
        return FileFilter::all;
    case FileWish::save_setup:
        return FileFilter::setups;
    case FileWish::save_sheet:
        return FileFilter::pages;
    }
    return FileFilter::all;
}

/// Whether what is typed is meant as a path and not as a part of a name.
bool is_path(const std::string& typed) {
    return typed == ".." || typed.starts_with('~') || typed.starts_with('"')
           || core::platform::with_slashes(typed).find('/') != std::string::npos;
}

std::string path_of_row(const FileBrowser& browser, size_t row) {
    const FolderEntry& entry = browser.listing->entries[browser.rows[row]];
    return (fs::path(browser.folder) / entry.name).generic_string();
}

void add_place(std::vector<FilePlace>& places, const char* name, const fs::path& path) {
    if (!path.empty()) places.push_back({name, path.generic_string()});
}

std::vector<FilePlace> places_of(const ViewModel& model) {
    std::vector<FilePlace> places;
    add_place(places, "Home", core::platform::home_folder());
    add_place(places, "Documents", core::platform::documents_folder());
    std::error_code failure;
    if (model.program)
        add_place(places, "Program", fs::absolute(model.program->program, failure).parent_path());
    add_place(places, "Samples", model.samples);
    for (const fs::path& drive : core::platform::drive_folders()) {
        const std::string name =
            drive.filename().empty() ? drive.generic_string() : drive.filename().generic_string();
        add_place(places, readable_name(name).c_str(), drive);
    }
    return places;
}

/// The file that the browser is about: the set-up, or else the program.
std::string file_in_question(const ViewModel& model, FileWish wish) {
    const std::string& setup = model.workspace.document.path();
    if (wish == FileWish::save_setup && !model.workspace.file_name.empty())
        return model.workspace.file_name;
    const std::string opened = !model.program ? std::string()
                               : saves(wish)  ? model.program->proposed_path
                                              : model.program->program;
    std::string file = wish == FileWish::open || setup.empty() ? opened : setup;
    if (wish == FileWish::save_sheet)
        file = fs::path(file).replace_extension(".html").generic_string();
    // Nothing is saved among the samples.
    if (saves(wish) && is_below(file, model.samples))
        return (own_folder() / fs::path(file).filename()).generic_string();
    return file;
}

std::string start_folder(const ViewModel& model, const std::string& file) {
    std::error_code failure;
    if (!file.empty()) return fs::absolute(file, failure).parent_path().generic_string();
    if (!model.browser.folder.empty()) return model.browser.folder;
    if (const auto home = core::platform::home_folder(); !home.empty())
        return home.generic_string();
    return fs::current_path(failure).generic_string();
}

/// The row of an entry with this name.
std::optional<size_t> row_named(const FileBrowser& browser, const std::string& name) {
    for (size_t row = 0; row < browser.rows.size(); ++row)
        if (browser.listing->entries[browser.rows[row]].name == name) return row;
    return {};
}

} // namespace

void choose_file(ViewModel& model, const std::string& path) {
    switch (model.browser.wish) {
    case FileWish::save_setup:
        model.save_path = path; // the browser closes once it is saved
        return;
    case FileWish::save_sheet:
        model.sheet_path = path; // likewise
        return;
    case FileWish::open:
        model.wanted_paths = {path};
        break;
    case FileWish::mesh:
        add_mesh(model, path);
        break;
    case FileWish::stock:
        use_stock_mesh(model, path);
        break;
    case FileWish::part:
        add_part(model, path);
        break;
    case FileWish::tools:
        use_tool_library(model, path);
        break;
    case FileWish::machine:
        is_ini_file(path) ? use_ini(model, path) : use_machine(model, path);
        break;
    case FileWish::job:
    case FileWish::offsets:
        model.job_file = path;
        break;
    }
    model.popup = Popup::none;
}

namespace {

/// Shows the folder of a listing.
void show_listing(FileBrowser& browser, std::shared_ptr<const FolderListing> listing) {
    const bool is_new = listing->folder != browser.folder;
    browser.folder = listing->folder;
    const bool is_typed_for = browser.typed == browser.typed_before; // and not for the new folder
    const bool is_name = saves(browser.wish) && !browser.typed.ends_with('/');
    if (is_new && is_typed_for && !is_name) set_typed(browser, "");
    if (is_new) browser.selected = 0;
    const std::string name =
        !is_new && browser.selected > 0 && browser.selected < browser.rows.size()
            ? browser.listing->entries[browser.rows[browser.selected]].name
            : browser.came_from;
    browser.listing = std::move(listing);
    update_rows(browser);
    if (const auto row = row_named(browser, name)) {
        browser.selected = *row;
        browser.wants_scroll = is_new || name == browser.came_from;
    }
    if (browser.listing->is_whole) browser.came_from.clear();
}

void take_listing(FileBrowser& browser, std::shared_ptr<const FolderListing> listing) {
    if (browser.wanted == listing->folder && listing->is_whole) browser.wanted.clear();
    if (listing->error.empty() || listing->folder == browser.folder)
        return show_listing(browser, std::move(listing));
    browser.error = readable_name(listing->folder) + ": " + listing->error;
    const std::string above = fs::path(listing->folder).parent_path().generic_string();
    if (!browser.listing && above != listing->folder) { // a start folder that is gone
        const std::string error = browser.error;
        look_at(browser, above);
        browser.error = error;
    }
}

/// Whether a file comes before another one; both are in order by name.
bool is_earlier(const FolderEntry& a, const FolderEntry& b, FileOrder order) {
    const bool a_file = a.kind != FileKind::folder, b_file = b.kind != FileKind::folder;
    if (a_file != b_file) return b_file;
    if (order == FileOrder::largest) return a_file && a.size > b.size;
    return a.modified > b.modified;
}

} // namespace

bool saves(FileWish wish) { return wish == FileWish::save_setup || wish == FileWish::save_sheet; }

FileEndings endings_for(FileWish wish) {
    switch (wish) {
    case FileWish::mesh:
    case FileWish::stock:
    case FileWish::part:
        return {"Meshes and CAD files",
                {"stl", "obj", "ply", "off", "step", "stp", "iges", "igs", "brep", "brp", "FCStd"}};
    case FileWish::tools:
        return {"Tool libraries", {"tools", "json", "hsmlib", "fctl", "fctb", "tbl"}};
    case FileWish::machine:
        return {"Machines", {"toml", "machine", "mch", "ini"}};
    case FileWish::job:
        return {"FreeCAD jobs", {"FCStd"}};
    case FileWish::save_setup:
        return {"Set-ups", {"toml"}};
    case FileWish::save_sheet:
        return {"Pages", {"html"}};
    case FileWish::open:
    case FileWish::offsets:
        break;
    }
    return {};
}

const char* title_of(FileWish wish) {
    switch (wish) {
    case FileWish::open:
        return "Open a program or a set-up";
    case FileWish::mesh:
        return "Add a mesh as a fixture";
    case FileWish::stock:
        return "Choose a mesh as the stock";
    case FileWish::part:
        return "Choose the finished part";
    case FileWish::tools:
        return "Open a tool library";
    case FileWish::machine:
        return "Choose the machine";
    case FileWish::job:
        return "Import a job of FreeCAD";
    case FileWish::offsets:
        return "Compare with offsets from the control";
    case FileWish::save_setup:
        return "Save the set-up";
    case FileWish::save_sheet:
        return "Save the set-up sheet";
    }
    return "";
}

const char* name_of(FileFilter filter) {
    switch (filter) {
    case FileFilter::openable:
        return "Programs and set-ups";
    case FileFilter::programs:
        return "Programs";
    case FileFilter::setups:
        return "Set-ups (.toml)";
    case FileFilter::machines:
        return "Machines";
    case FileFilter::meshes:
        return "Meshes and CAD files";
    case FileFilter::tools:
        return "Tool libraries";
    case FileFilter::pages:
        return "Pages (.html)";
    case FileFilter::all:
        return "All files";
    }
    return "";
}

void browse(ViewModel& model, FileWish wish, const std::string& folder) {
    FileBrowser& browser = model.browser;
    if (browser.is_asking) return;
    browse_here(model, wish, folder);
    if (!browser.uses_system) return;
    browser.wants_system = true;
    model.popup = Popup::none;
}

void browse_here(ViewModel& model, FileWish wish, const std::string& folder) {
    FileBrowser& browser = model.browser;
    const std::string file = file_in_question(model, wish);
    const std::string start = folder.empty() ? start_folder(model, file) : folder;
    if (start != browser.folder) browser.listing.reset();
    browser.wish = wish;
    browser.filter = filter_for(wish);
    set_typed(browser, saves(wish) ? fs::path(file).filename().generic_string() : "");
    browser.selected = 0;
    browser.wants_focus = true;
    browser.places = places_of(model);
    look_at(browser, start);
    update_rows(browser);
    model.popup = Popup::open_file;
}

void close_browser(ViewModel& model) {
    if (model.workspace.is_naming) {
        model.workspace.is_naming = false;
        model.workspace.leaving = Leaving::no;
        model.workspace.refusal.clear();
        model.workspace.file_name.clear();
    }
    model.popup = Popup::none;
}

void set_typed(FileBrowser& browser, const std::string& text) {
    browser.typed = text;
    browser.replaced = text;
}

void look_at(FileBrowser& browser, const std::string& path) {
    browser.error.clear();
    browser.wanted = path;
    browser.typed_before = browser.typed;
    browser.has_order = true;
}

void go_up(FileBrowser& browser) {
    const fs::path folder = browser.wanted.empty() ? browser.folder : browser.wanted;
    const fs::path above = folder.parent_path();
    if (above.empty() || above == folder) return;
    look_at(browser, above.generic_string());
    browser.came_from = folder.filename().generic_string();
}

void update_rows(FileBrowser& browser) {
    browser.rows.clear();
    if (!browser.listing) return;
    const bool filters = !saves(browser.wish) && !is_path(browser.typed);
    const std::string typed = filters ? core::lower_case(browser.typed) : std::string();
    const bool shows_hidden = browser.shows_hidden || typed.starts_with('.');
    std::optional<size_t> first; // row whose name begins so
    const auto& entries = browser.listing->entries;
    for (size_t i = 0; i < entries.size(); ++i) {
        const FolderEntry& entry = entries[i];
        if (entry.is_hidden && !shows_hidden) continue;
        if (entry.kind != FileKind::folder && !passes(browser.filter, entry.kind)) continue;
        if (!typed.empty() && entry.key.find(typed) == std::string::npos) continue;
        if (!typed.empty() && !first && entry.key.starts_with(typed)) first = browser.rows.size();
        browser.rows.push_back(i);
    }
    if (browser.order != FileOrder::name)
        std::stable_sort(browser.rows.begin(), browser.rows.end(), [&](size_t a, size_t b) {
            return is_earlier(entries[a], entries[b], browser.order);
        });
    else if (first)
        browser.selected = *first;
    browser.selected =
        std::min(browser.selected, browser.rows.empty() ? 0 : browser.rows.size() - 1);
}

void move_selection(FileBrowser& browser, int rows) {
    if (browser.rows.empty()) return;
    const auto last = static_cast<ptrdiff_t>(browser.rows.size()) - 1;
    const ptrdiff_t wanted = static_cast<ptrdiff_t>(browser.selected) + rows;
    browser.selected = static_cast<size_t>(std::clamp<ptrdiff_t>(wanted, 0, last));
    browser.wants_scroll = true;
}

void enter_typed(ViewModel& model) {
    FileBrowser& browser = model.browser;
    const std::string& typed = browser.typed;
    const bool is_folder = typed.ends_with('/') || typed == ".." || typed == "~";
    if (saves(browser.wish) && !typed.empty() && !is_folder) {
        std::string path = meant_path(browser, typed);
        if (fs::path(path).extension().empty())
            path += browser.wish == FileWish::save_setup ? ".toml" : ".html";
        return choose_file(model, path);
    }
    if (!typed.empty() && (is_path(typed) || browser.rows.empty()))
        return look_at(browser, meant_path(browser, typed));
    if (!browser.rows.empty()) open_row(model, browser.selected);
}

void open_row(ViewModel& model, size_t row) {
    FileBrowser& browser = model.browser;
    if (row >= browser.rows.size()) return;
    const FolderEntry& entry = browser.listing->entries[browser.rows[row]];
    browser.selected = row;
    if (entry.is_broken) {
        browser.error = entry.shown + " leads nowhere or cannot be read";
    } else if (entry.kind == FileKind::folder) {
        look_at(browser, path_of_row(browser, row));
    } else if (saves(browser.wish)) {
        set_typed(browser, entry.name);
    } else {
        choose_file(model, path_of_row(browser, row));
    }
}

void open_recent(ViewModel& model, const RecentProgram& recent) {
    model.wanted_paths = {recent.program};
    if (!recent.setup.empty()) model.wanted_paths.push_back(recent.setup);
    model.popup = Popup::none;
}

void open_last(ViewModel& model, double now) {
    const std::string current = model.program ? absolute_path(model.program->program) : "";
    for (const RecentProgram& recent : model.recent)
        if (recent.program != current && !model.browser.missing.contains(recent.program))
            return open_recent(model, recent);
    say(model, "No other program has been opened yet", now);
}

bool take_in(ViewModel& model, FolderUpdate news) {
    FileBrowser& browser = model.browser;
    if (!news.has_news || news.run != browser.run) return false;
    bool has_changed = false;
    if (news.listing && model.popup == Popup::open_file) {
        take_listing(browser, std::move(news.listing));
        has_changed = true;
    }
    if (news.is_file && !browser.wanted.empty() && model.popup == Popup::open_file) {
        const std::string path = std::exchange(browser.wanted, {});
        if (saves(browser.wish))
            browser.error = readable_name(path) + " is a file, not a folder";
        else
            choose_file(model, path);
        has_changed = true;
    }
    if (news.missing_files) {
        has_changed = has_changed || browser.missing != *news.missing_files;
        browser.missing = *std::move(news.missing_files);
        browser.is_busy = false;
    }
    return has_changed;
}

bool send_browser_orders(ViewModel& model, FolderWorker& worker, double now) {
    FileBrowser& browser = model.browser;
    const bool is_open = model.popup == Popup::open_file;
    const bool is_empty = !model.program && !model.is_busy;
    if (!is_open && !is_empty) return false;
    const bool is_due = !browser.is_busy && now >= browser.look_again;
    if (!is_due && !(is_open && browser.has_order)) return false;
    FolderJob job;
    if (is_open) {
        job.path = browser.wanted.empty() ? browser.folder : browser.wanted;
        if (!browser.has_order && browser.listing && browser.listing->is_whole)
            job.known = browser.listing->modified;
        browser.has_order = false;
    }
    browser.is_busy = true;
    for (const RecentProgram& recent : model.recent) job.files.push_back(recent.program);
    browser.look_again = now + look_interval;
    browser.run = worker.start(std::move(job));
    return true;
}

std::string meant_path(const FileBrowser& browser, const std::string& typed) {
    std::string path = typed;
    if (path.size() > 1 && path.starts_with('"') && path.ends_with('"'))
        path = path.substr(1, path.size() - 2);
    path = core::platform::with_slashes(path);
    const std::string home = core::platform::home_folder().generic_string();
    if (path == "~" || path.starts_with("~/")) path = home + path.substr(1);
    const fs::path whole = (fs::path(browser.folder) / path).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).generic_string();
}

std::string size_words(uint64_t bytes) {
    if (bytes < 1000) return fmt::format("{} B", bytes);
    auto value = static_cast<double>(bytes);
    for (const char* unit : {"KB", "MB", "GB", "TB"}) {
        value /= 1000.0;
        if (value < 999.95) return fmt::format("{:.1f} {}", value, unit);
    }
    return fmt::format("{:.0f} PB", value / 1000.0);
}

std::string date_words(int64_t nanoseconds) {
    constexpr int64_t second = 1'000'000'000;
    if (nanoseconds < 86'400 * second) return {};
    return fmt::format("{:%Y-%m-%d %H:%M}",
                       fmt::localtime(static_cast<std::time_t>(nanoseconds / second)));
}

} // namespace app::viewer
