#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace app::viewer {

struct FolderListing;
struct FolderUpdate;
class FolderWorker;
struct ViewModel;

/// A program that was opened, with its set-up.
struct RecentProgram {
    std::string program, setup; // absolute paths; `setup` is empty if it was inferred

    bool operator==(const RecentProgram&) const = default;
};

/// What a file is wanted for.
enum class FileWish : uint8_t {
    open,
    mesh,
    stock,
    part,
    tools,
    machine,
    job,     // of a CAM system
    offsets, // from the control
    save_setup,
    save_sheet
};

/// Whether a file is to be written.
bool saves(FileWish wish);

/// Which files are listed; folders always are.
enum class FileFilter : uint8_t { openable, programs, setups, machines, meshes, tools, pages, all };

constexpr FileFilter file_filters[] = {
    FileFilter::openable, FileFilter::programs, FileFilter::setups, FileFilter::machines,
    FileFilter::meshes,   FileFilter::tools,    FileFilter::pages,  FileFilter::all};

const char* name_of(FileFilter filter);

/// The endings of the files that are wanted, without a dot, and what they are called; none: any.
struct FileEndings {
    std::string name;
    std::vector<std::string> endings;
};
FileEndings endings_for(FileWish wish);

/// The title of the dialog.
const char* title_of(FileWish wish);

/// The order of the files; folders always come first.
enum class FileOrder : uint8_t { name, newest, largest };

/// A folder that is one click away.
struct FilePlace {
    std::string name, path;
};

/// The file browser: a folder, what is typed, and the selected row.
///
/// One field has the keyboard all the time. What is typed there filters the list by name, unless it
/// looks like a path; when saving, it is the name of the file.
struct FileBrowser {
    FileWish wish{};
    FileFilter filter{};
    FileOrder order{};
    bool shows_hidden = false;
    std::string typed;
    std::optional<std::string> replaced;          // puts this text into the field
    std::string folder;                           // that is shown; empty: none yet
    std::shared_ptr<const FolderListing> listing; // of `folder`
    std::vector<size_t> rows;                     // entries of the listing that pass the filter
    size_t selected = 0;                          // row
    std::string error;                            // why the last path cannot be opened
    std::vector<FilePlace> places;
    std::set<std::string> missing; // programs of the recent ones that are not there
    bool wants_focus = false;      // the field gets the keyboard in the next frame
    bool wants_scroll = false;     // the list scrolls to the selected row in the next frame

    // of the dialog of the system, which takes the place of this one
    bool uses_system = false;  // if there is one
    bool wants_system = false; // it is to be opened, in the folder `wanted`
    bool is_asking = false;    // it is open

    // of the work in the background
    std::string wanted;       // path to look at; empty: none
    std::string came_from;    // name of the folder that was left upwards
    uint64_t run = 0;         // number of the job
    bool is_busy = false;     // the job is not done
    bool has_order = false;   // a job is to be sent
    double look_again = 0.0;  // seconds
    std::string typed_before; // when the path was asked for
};

/// Opens the dialog of the system, or else the browser, in a folder; empty: in that of the file
/// that is meant.
void browse(ViewModel& model, FileWish wish, const std::string& folder = {});
/// Opens the browser although the system has a dialog.
void browse_here(ViewModel& model, FileWish wish, const std::string& folder = {});
/// Closes it without a choice.
void close_browser(ViewModel& model);

/// Puts a text into the field.
void set_typed(FileBrowser& browser, const std::string& text);

/// Looks at a path: a folder is shown, a file is chosen.
void look_at(FileBrowser& browser, const std::string& path);
/// Goes to the folder above, and selects the one that was left.
void go_up(FileBrowser& browser);
/// Applies the filter and what is typed.
void update_rows(FileBrowser& browser);
/// Moves the selection by rows, within the list.
void move_selection(FileBrowser& browser, int rows);

/// Does with a file what it is wanted for.
void choose_file(ViewModel& model, const std::string& path);

/// What Enter does: takes the path or name that is typed, or else opens the selected row.
void enter_typed(ViewModel& model);
/// What a double click does: enters a folder, chooses a file.
void open_row(ViewModel& model, size_t row);

/// Opens a program of the list with its set-up.
void open_recent(ViewModel& model, const RecentProgram& recent);
/// Opens the program that was open last, other than the current one. `now`: seconds.
void open_last(ViewModel& model, double now);

/// Takes in what was found; ignores updates of earlier jobs. True if anything has changed.
bool take_in(ViewModel& model, FolderUpdate news);
/// Sends the jobs that the model requires: paths to look at, and every two seconds the question of
/// what has changed. `now`: seconds. True if a job was sent.
bool send_browser_orders(ViewModel& model, FolderWorker& worker, double now);

/// The whole path that a user means: `~` is the home folder, quotes are taken off.
std::string meant_path(const FileBrowser& browser, const std::string& typed);

/// "812 B", "3.4 KB", "12.0 MB".
std::string size_words(uint64_t bytes);
/// "2026-11-27 05:12", in the local time; empty outside the years 1970 to 9999.
std::string date_words(int64_t nanoseconds);

} // namespace app::viewer
