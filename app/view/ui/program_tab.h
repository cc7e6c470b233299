#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "app/check/check_job.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/tolerance_worker.h"
#include "app/view/model/unsaved_setup.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/window.h"

namespace app::viewer {

struct WindowJob;

/// One open program of the window: what is known and entered about it, the threads that check it,
/// and its panels. Without a program it shows the welcome screen.
class ProgramTab {
public:
    /// `wake`: called from the threads when there is something new. Needs the context of the
    /// window.
    ProgramTab(const WindowJob& job, render::Renderer renderer, std::function<void()> wake);
    /// Aborts all that the threads do.
    ~ProgramTab();

    ViewModel model;
    Layout layout;
    bool may_drop = false; // the user said so: its edits, when the window closes

    const std::optional<CheckJob>& check() const { return check_; }
    /// Whether opening another program may take this place: there is none, or it cannot be opened.
    bool is_vacant() const;
    /// Opens a program with the set-up of a job, and looks for edits that were not saved.
    void open(const CheckJob& check);
    /// Checks the program again, with its files and the set-up as they are now.
    void reload();
    /// Whether the check of the program goes on.
    bool is_checking() const { return check_ && !model.is_recorded && !model.failure; }
    /// Stops the check until further notice: those of other programs go first.
    void rest(bool rests) { worker_.rest(rests); }

    /// Takes in what the threads have published. True if there was anything.
    bool take_updates(double now);
    /// Passes requests of the user to the threads. True if there were any.
    bool send_orders();
    /// Whether the session was asked for something since the last call, so an answer is near.
    bool has_asked();
    /// Reads files again that have changed. Edits of the set-up are never lost that way. True if
    /// there is something to show.
    bool take_changed_files(double now);

    /// Saves the set-up if the user wants it. True if it was saved.
    bool save_if_wanted(double now);
    /// Makes the set-up sheet in a thread of its own if the user wants it, and saves it.
    void make_sheet_if_wanted(double now);
    /// Reads a file of a CAM system or a control in a thread of its own if the user wants it, and
    /// shows what it says. True if there is something new.
    bool read_job_file_if_wanted(double now);
    /// Checks the program again after an edit, and keeps the edit a moment later.
    void take_edits(double now);
    /// Keeps edits at once, before another program is shown or the window ends.
    void keep_edits();
    /// Removes what is kept of edits that were not saved.
    void forget_edits();

private:
    void watch(std::vector<std::string> files);
    bool take_sheet(double now);

    const WindowJob& job_;
    std::optional<CheckJob> check_;
    FileWatch files_;
    UnsavedSetups unsaved_;
    uint64_t checked_version_ = 0;  // of the document
    std::optional<double> keep_at_; // seconds
    UnsavedSetups::File kept_;      // keeps the edits of this session
    bool has_asked_ = false;
    std::string sheet_path_; // of the sheet that is being made
    std::atomic<bool> sheet_goes_on_ = true;
    std::future<core::Result<std::string>> sheet_;
    std::string read_text_; // the set-up when the file below was chosen
    std::future<JobFileNews> job_file_;
    std::function<void()> wake_;
    SessionWorker worker_;
    DeviceWorker device_;
    ToleranceWorker tolerances_; // last, so that the threads end before the other members
};

} // namespace app::viewer
