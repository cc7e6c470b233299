#include "app/view/ui/program_tab.h"

#include <chrono>
#include <utility>

#include "app/view/model/file_browser.h"
#include "app/view/model/navigation.h"
#include "app/view/model/tolerance_sheet.h"
#include "app/view/ui/command.h"
#include "app/view/ui/window.h"
#include "core/base/file_reads.h"
#include "render/renderer.h"

namespace app::viewer {

ProgramTab::ProgramTab(const WindowJob& job, render::Renderer renderer, std::function<void()> wake)
    : layout(std::move(renderer)),
      job_(job),
      unsaved_(job.unsaved, job.write),
      wake_(wake),
      worker_(wake),
      device_(wake),
      tolerances_(wake) {
    model.device.file = job.device.file;
    model.device.shown = job.device.shown;
}

ProgramTab::~ProgramTab() {
    sheet_goes_on_ = false; // and its thread ends before the other members
    if (sheet_.valid()) sheet_.wait();
    if (job_file_.valid()) job_file_.wait();
}

bool ProgramTab::is_vacant() const {
    const bool runs_nothing = model.is_recorded && !model.has_rows();
    return !check_ || ((model.failure || runs_nothing) && !model.workspace.document.is_modified());
}

void ProgramTab::open(const CheckJob& check) {
    check_ = check;
    model.opened_path = check.program;
    const std::string text = check.setup.empty() ? "" : core::file_bytes(check.setup).value_or("");
    open_document(model, SetupDocument(check.setup, text));
    model.workspace.found = unsaved_.find(check.program, check.setup, text);
    // Edits from before the set-up had a file.
    if (!check.setup.empty() && model.workspace.found.empty())
        model.workspace.found = unsaved_.find(check.program, "", text);
    keep_at_.reset();
    kept_ = {};
    watch({});
    reload();
    if (!model.workspace.found.empty()) show_setup(model, true);
}

void ProgramTab::reload() {
    if (!check_) return;
    const SetupDocument& document = model.workspace.document;
    checked_version_ = document.version();
    check_->setup = document.path();
    // The text that is shown, even if the file changes just now.
    check_->setup_text.reset();
    if (!document.path().empty() || !document.text().empty()) check_->setup_text = document.text();
    worker_.set_breakpoints(model.breakpoints);
    model.reading = worker_.open(*check_);
}

void ProgramTab::watch(std::vector<std::string> files) {
    for (const std::string& own : {check_->program, check_->setup, job_.device.file})
        files.push_back(own);
    files_.set(files);
}

bool ProgramTab::take_updates(double now) {
    SessionUpdate news = worker_.take();
    DeviceUpdate answers = device_.take();
    ToleranceUpdate found = tolerances_.take();
    if (!news.files.empty()) watch(news.files);
    const bool has_sheet = take_sheet(now);
    const bool has_news = news.has_news || answers.has_news || found.has_news || has_sheet;
    take_in(model, std::move(news), now);
    take_in(model, std::move(answers));
    take_in(model, std::move(found));
    return has_news;
}

bool ProgramTab::send_orders() {
    bool any = send_device_orders(model, device_, check_);
    any = send_tolerance_orders(model, tolerances_, check_) || any;
    const bool asks = send_requests(model, worker_);
    has_asked_ = has_asked_ || asks;
    return any || asks;
}

bool ProgramTab::has_asked() { return std::exchange(has_asked_, false); }

bool ProgramTab::take_changed_files(double now) {
    const bool has_changed = check_ && files_.has_changed();
    const bool is_news = has_changed || model.missing != files_.missing();
    model.missing = files_.missing();
    if (!has_changed) return is_news;
    Workspace& workspace = model.workspace;
    const std::string& path = workspace.document.path();
    const auto text = path.empty() ? std::nullopt : core::file_bytes(path);
    if (text && *text != workspace.document.saved_text()) {
        if (workspace.document.is_modified()) {
            workspace.on_disk = *text;
            show_setup(model, true);
        } else {
            take_file(model, *text);
        }
    }
    reload();
    if (!workspace.on_disk) say(model, "A file has changed: reloading", now);
    return true;
}

bool ProgramTab::save_if_wanted(double now) {
    Workspace& workspace = model.workspace;
    const bool is_wanted = std::exchange(model.wants_saving, false) || !model.save_path.empty();
    if (!is_wanted || !check_) return false;
    if (workspace.is_typing) { // what is typed is to be saved, too
        workspace.commits_typed = model.wants_saving = true;
        return false;
    }
    const std::string before = workspace.document.path();
    if (!save_document(model, std::exchange(model.save_path, {}), job_.write, now)) {
        // The browser says why a name was refused; the dialog of the system cannot.
        if (workspace.is_naming && model.popup != Popup::open_file)
            (workspace.refusal.empty() ? browse : browse_here)(model, FileWish::save_setup, {});
        return false;
    }
    if (model.popup == Popup::open_file) model.popup = Popup::none;
    forget_edits();
    check_->setup = workspace.document.path();
    files_.take_as_known(check_->setup);
    if (workspace.document.path() != before) reload();
    return true;
}

void ProgramTab::make_sheet_if_wanted(double now) {
    if (!check_ || model.sheet_path.empty()) return;
    Workspace& workspace = model.workspace;
    std::string path = std::exchange(model.sheet_path, {});
    const bool may_replace = std::exchange(workspace.may_replace, false);
    if (sheet_.valid()) return say(model, "Another set-up sheet is being made: wait for it", now);
    if (!may_replace && core::why_no_file(path).empty()) {
        workspace.refusal = path + " already exists";
        if (model.popup != Popup::open_file) say(model, workspace.refusal, now);
        return;
    }
    model.popup = Popup::none;
    workspace.refusal.clear();
    sheet_path_ = std::move(path);
    sheet_goes_on_ = true;
    say(model, "The set-up sheet is being made", now);
    sheet_ = std::async(std::launch::async, [this, check = *check_, make = job_.make_sheet] {
        auto sheet = make(check, [this] { return sheet_goes_on_.load(); });
        wake_();
        return sheet;
    });
}

/// Saves a sheet that is made. True if there was one.
bool ProgramTab::take_sheet(double now) {
    if (!sheet_.valid() || sheet_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return false;
    const core::Result<std::string> sheet = sheet_.get();
    if (!sheet) {
        say(model, "There is no set-up sheet: " + sheet.error().message, now);
        return true;
    }
    const auto written = job_.write(sheet_path_, *sheet);
    say(model,
        written ? "Saved " + sheet_path_ + ": open it in a browser to print it"
                : sheet_path_ + " cannot be written: " + written.error().message,
        now);
    return true;
}

bool ProgramTab::read_job_file_if_wanted(double now) {
    const std::string path = std::exchange(model.job_file, {});
    if (!path.empty() && check_ && !job_file_.valid()) {
        CheckJob check = *check_;
        read_text_ = model.workspace.document.text();
        check.setup_text.reset();
        if (!read_text_.empty()) check.setup_text = read_text_;
        say(model, "Reading " + path, now);
        job_file_ = std::async(std::launch::async, [this, check, path, read = job_.read_job_file] {
            auto news = read(check, path);
            wake_();
            return news;
        });
    }
    const bool is_read =
        job_file_.valid()
        && job_file_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_read) return false;
    auto news = job_file_.get();
    const bool is_outdated =
        (news.setup_text || news.proposed) && read_text_ != model.workspace.document.text();
    if (is_outdated) news.text = "The set-up was edited meanwhile: open the file again.\n";
    if (news.setup_text && !is_outdated) {
        edit_setup(model, news.title, [&](const std::string&) { return *news.setup_text; });
        show_setup(model, true);
    }
    model.message_until = now;
    model.report_title = news.title;
    model.report_text = news.text;
    model.report_setup = is_outdated ? std::nullopt : std::move(news.proposed);
    model.report_question = news.question;
    model.report_version = model.workspace.document.version();
    model.popup = Popup::report;
    return true;
}

void ProgramTab::take_edits(double now) {
    constexpr double keep_delay = 1.0; // seconds
    if (!check_) return;
    Workspace& workspace = model.workspace;
    if (workspace.on_disk && !workspace.document.is_modified())
        take_file(model, *std::exchange(workspace.on_disk, std::nullopt));
    if (model.workspace.document.version() != checked_version_) {
        reload();
        keep_at_ = now + keep_delay;
    }
    const auto answered = std::exchange(model.workspace.answered, {});
    if ((keep_at_ && now >= *keep_at_) || !answered.empty()) keep_edits();
    const bool is_safe = !model.workspace.document.is_modified() || core::is_there(kept_.path);
    for (const UnsavedSetup& each : answered)
        if (is_safe) UnsavedSetups::forget(each.file);
}

void ProgramTab::keep_edits() {
    if (!check_ || !std::exchange(keep_at_, std::nullopt)) return;
    const SetupDocument& document = model.workspace.document;
    if (!document.is_modified()) return forget_edits();
    if (kept_.path.empty()) kept_ = unsaved_.free_file(check_->program, document.path());
    unsaved_.keep(kept_.path, check_->program, document.path(), document.text(),
                  document.saved_text());
}

void ProgramTab::forget_edits() {
    UnsavedSetups::forget(std::exchange(kept_, {}).path);
    keep_at_.reset();
}

} // namespace app::viewer
