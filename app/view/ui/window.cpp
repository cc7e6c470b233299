#include "app/view/ui/window.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include "app/check/check_job.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/model/recent_files.h"
#include "app/view/model/samples.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/settings.h"
#include "app/view/model/tolerance_sheet.h"
#include "app/view/model/tolerance_worker.h"
#include "app/view/model/unsaved_setup.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/command.h"
#include "app/view/ui/imgui_backends.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/system_dialog.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "render/image.h"
#include "render/renderer.h"

namespace app::viewer {

/// Logs when keys were pressed and frames were drawn, to measure how fast the window responds.
/// Times are in seconds since 1970.
///
///     key TIME CODE
///     frame BEGIN END CURSOR SHOWN PATH    the cursor's block, the block whose stock is shown (-1:
///                                          none yet), points of the path
class FrameLog {
public:
    /// Writes nothing if the path is empty.
    explicit FrameLog(const std::filesystem::path& path);

    void key(int code);
    /// To be called before and after a frame is drawn.
    void begin_frame();
    void end_frame(const ViewModel& model);

private:
    std::ofstream file_;
    double begin_ = 0.0;
};

/// A queue of key events for ImGui 1.86, which only sees whether a key is down during a frame.
///
/// A key that is pressed and released between two frames gets one frame for each event. A modifier
/// released after a key press still counts as down in the frame of that press.
class KeyQueue {
public:
    /// Adds an event of a key with this GLFW code.
    void add(int code, bool is_down);

    /// Passes ImGui the events for the next frame. True if some are left for later frames.
    bool feed(ImGuiIO& io);

private:
    std::deque<std::pair<int, bool>> keys_;
};

/// The contents of the window's framebuffer. The context of the window must be current.
render::Image screen_picture(int width, int height);

/// The first unused file name in a folder: feeler-0001.png and so on.
std::filesystem::path free_picture_name(const std::filesystem::path& folder);

namespace {

static_assert(key::left == GLFW_KEY_LEFT && key::function(12) == GLFW_KEY_F12
              && key::escape == GLFW_KEY_ESCAPE && key::of('G') == GLFW_KEY_G
              && key::keypad_add == GLFW_KEY_KP_ADD && key::slash == GLFW_KEY_SLASH
              && key::left_bracket == GLFW_KEY_LEFT_BRACKET && key::end == GLFW_KEY_END
              && key::left_control == GLFW_KEY_LEFT_CONTROL && key::right_alt == GLFW_KEY_RIGHT_ALT
              && mod::shift == GLFW_MOD_SHIFT && mod::control == GLFW_MOD_CONTROL
              && mod::alt == GLFW_MOD_ALT);

/// Interval between checks of the files, and longest sleep of the window, seconds.
constexpr double watch_interval = 0.4;
constexpr double frame_time = 1.0 / 60.0;
/// Typical time to make the view of a block, seconds. After a step the window waits this long, to
/// draw one frame instead of two.
constexpr double answer_time = 0.015;

struct Glfw {
    bool is_open = glfwInit() == GLFW_TRUE;
    ~Glfw() {
        if (is_open) glfwTerminate();
    }
};

/// ImGui with its two backends.
struct Gui {
    explicit Gui(GLFWwindow* window) {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.KeyRepeatDelay = 1e9F; // the operating system repeats keys
        io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
        ImGui_ImplGlfw_InitForOpenGL(window, true);
        ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    ~Gui() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
};

class Window {
public:
    Window(const WindowJob& job, GLFWwindow* window, render::Renderer renderer)
        : job_(job),
          check_(job.check ? std::optional(*job.check) : std::nullopt),
          window_(window),
          gui_(window),
          layout_(std::move(renderer)),
          unsaved_(job.unsaved, job.write),
          recent_(job.recent_file, job.write),
          log_(job.frame_log),
          worker_([] { glfwPostEmptyEvent(); }),
          folders_([] { glfwPostEmptyEvent(); }),
          dialog_([] { glfwPostEmptyEvent(); }),
          device_([] { glfwPostEmptyEvent(); }),
          tolerances_([] { glfwPostEmptyEvent(); }) {
        model.recent = recent_.programs();
    }

    ViewModel model;

    void run();
    void press(int code, int modifiers);
    void type(int code, bool is_down) { keys_.add(code, is_down); }
    void drop(const std::vector<std::string>& paths);
    void damage() { frames_ = 3; }
    void open_job();
    /// Closes, or asks first if there are unsaved edits.
    void close();

private:
    void update();
    void draw();
    void rebuild_fonts();
    void save_picture();
    void watch_files();
    void open(const CheckJob& check);
    void go_back();
    void remember_opened();
    void read_recent();
    void ask_system_dialog();
    void take_answer();
    void take_changed_files(double now);
    void update_setup(double now);
    void leave();
    void remember_geometry();
    void set_title();
    double wanted_scale() const;

    /// A program that another one replaces, with what was entered for it.
    struct Left {
        CheckJob check;
        Workspace workspace;
        std::vector<Breakpoint> breakpoints;
        std::set<size_t> bookmarks;
        std::optional<BlockRow> row;
    };

    WindowJob job_;
    std::optional<CheckJob> check_; // the open job
    std::optional<Left> left_;      // the one before it, until it is read
    RecentProgram remembered_;      // in the list of recent programs
    GLFWwindow* window_;
    Gui gui_;
    Layout layout_;
    Fonts fonts_;
    std::string title_;
    std::optional<render::ColorScheme> styled_;
    FileWatch files_;
    UnsavedSetups unsaved_;
    RecentFiles recent_;
    uint64_t opened_version_ = 0;           // of the document that is checked
    std::optional<double> keep_unsaved_at_; // seconds
    FrameLog log_;
    KeyQueue keys_;
    double last_watch_ = 0.0, last_frame_ = 0.0;
    bool asked_ = false; // a request has just been sent to the worker
    int frames_ = 3;     // still to draw: ImGui needs several to settle the layout
    SessionWorker worker_;
    FolderWorker folders_;
    SystemDialog dialog_;
    uint64_t asked_dialog_ = 0; // number of the question
    DeviceWorker device_;
    ToleranceWorker tolerances_; // last, so that the threads end before the other members
};

double Window::wanted_scale() const {
    float x = 1.0F, y = 1.0F;
    glfwGetWindowContentScale(window_, &x, &y);
    int width = 1, height = 1, pixels = 1, rows = 1;
    glfwGetWindowSize(window_, &width, &height);
    glfwGetFramebufferSize(window_, &pixels, &rows);
    // If screen coordinates are not pixels, the system already scales the window.
    const double scaled = width > 0 ? static_cast<double>(pixels) / width : 1.0;
    return std::clamp(static_cast<double>(x) / std::max(scaled, 1.0), 0.5, 4.0)
           * model.settings.scale;
}

void Window::rebuild_fonts() {
    const double scale = wanted_scale();
    if (fonts_.text && fonts_.scale == scale && styled_ == model.settings.theme) return;
    if (!fonts_.text || fonts_.scale != scale) {
        fonts_ = load_fonts(scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
    apply_style(Theme{model.settings.theme}, scale);
    styled_ = model.settings.theme;
}

/// Checks the open program with the set-up as it is now.
void Window::open_job() {
    if (!check_) return;
    const SetupDocument& document = model.workspace.document;
    opened_version_ = document.version();
    check_->setup = document.path();
    check_->setup_text.reset();
    if (document.is_modified()) check_->setup_text = document.text();
    worker_.set_breakpoints(model.breakpoints);
    worker_.open(*check_);
    watch_files();
    damage();
}

void Window::watch_files() {
    std::vector<std::string> files = files_of_setup(check_->setup);
    files.push_back(check_->program);
    if (!job_.device.file.empty()) files.push_back(job_.device.file);
    files_.set(std::move(files));
}

/// Opens a program with the set-up of a job.
void Window::open(const CheckJob& check) {
    if (check_ && model.program && !model.failure && check.program != check_->program)
        left_ = Left{*check_, model.workspace, model.breakpoints, model.bookmarks,
                     model.has_rows() ? std::optional(model.row()) : std::nullopt};
    if (check_ && check.program != check_->program) model.breakpoints.clear();
    check_ = check;
    const std::string text = check.setup.empty() ? "" : core::file_bytes(check.setup).value_or("");
    open_document(model, SetupDocument(check.setup, text));
    if (auto unsaved = unsaved_.find(check.program, check.setup, text))
        model.workspace.found = std::move(unsaved->text);
    keep_unsaved_at_.reset();
    open_job();
    if (model.workspace.found) show_setup(model, true);
}

/// Returns from a program that cannot be opened to the one before it.
void Window::go_back() {
    if (!left_) return;
    Left left = *std::exchange(left_, std::nullopt);
    check_ = std::move(left.check);
    model.workspace = std::move(left.workspace);
    model.breakpoints = std::move(left.breakpoints);
    model.bookmarks = std::move(left.bookmarks);
    model.resume = std::move(left.row);
    model.opens_another = false;
    open_job();
}

/// Shows what other windows have added to the list of recent programs.
void Window::read_recent() {
    recent_.read();
    if (model.recent == recent_.programs()) return;
    model.recent = recent_.programs();
    damage();
}

/// Opens the file dialog of the system, if that is requested.
void Window::ask_system_dialog() {
    FileBrowser& browser = model.browser;
    if (!std::exchange(browser.wants_system, false)) return;
    browser.is_asking = true;
    asked_dialog_ = dialog_.start({.wish = browser.wish,
                                   .title = title_of(browser.wish),
                                   .folder = browser.wanted,
                                   .name = browser.typed,
                                   .window = native_window(window_)});
}

/// Takes the answer of the user in that dialog, or opens the browser if the system has none.
void Window::take_answer() {
    const DialogUpdate answer = dialog_.take();
    FileBrowser& browser = model.browser;
    if (!answer.has_news || answer.run != asked_dialog_ || !browser.is_asking) return;
    browser.is_asking = false;
    damage();
    if (answer.is_absent) {
        browser.uses_system = false;
        return browse_here(model, browser.wish);
    }
    if (!answer.path) return close_browser(model);
    // That dialog has asked whether an existing file may be replaced.
    model.workspace.may_replace = browser.wish == FileWish::save_setup;
    choose_file(model, *answer.path);
}

/// Puts the open program into the list of recent ones, and forgets the one before it.
void Window::remember_opened() {
    const bool is_open = check_ && model.program && model.has_rows() && !model.failure
                         && model.program->program == check_->program;
    const bool has_failed = model.failure || (model.is_recorded && !model.has_rows());
    const std::string back =
        left_ && has_failed
            ? std::filesystem::path(left_->check.program).filename().generic_string()
            : std::string();
    if (back != model.back_to) damage();
    model.back_to = back;
    if (!is_open) return;
    left_.reset();
    RecentProgram opened{check_->program, model.workspace.document.path()};
    if (opened == remembered_) return;
    recent_.add(opened.program, opened.setup);
    model.recent = recent_.programs();
    remembered_ = std::move(opened);
}

void Window::drop(const std::vector<std::string>& paths) {
    damage();
    if (!can_open(paths, model, glfwGetTime())) return;
    const bool opens = std::any_of(paths.begin(), paths.end(),
                                   [](const std::string& path) { return !is_part_of_setup(path); });
    Workspace& workspace = model.workspace;
    if (opens && workspace.document.is_modified() && !workspace.drops_edits) {
        workspace.leaving = Leaving::to_open;
        workspace.leaving_for = paths;
        model.popup = Popup::leaving;
        return;
    }
    const auto check = with_dropped(check_.value_or(CheckJob{}), paths, model, glfwGetTime());
    if (check) open(*check);
}

void Window::close() {
    Workspace& workspace = model.workspace;
    if (!workspace.document.is_modified()) return glfwSetWindowShouldClose(window_, GLFW_TRUE);
    workspace.leaving = Leaving::to_close;
    model.popup = Popup::leaving;
    damage();
}

/// Does what the user wanted to do when edits were not saved, after they were saved or dropped.
void Window::leave() {
    Workspace& workspace = model.workspace;
    const Leaving leaving = std::exchange(workspace.leaving, Leaving::no);
    if (check_) unsaved_.forget(check_->program, workspace.document.path());
    keep_unsaved_at_.reset();
    if (leaving == Leaving::to_close) return glfwSetWindowShouldClose(window_, GLFW_TRUE);
    const std::vector<std::string> paths = std::exchange(workspace.leaving_for, {});
    workspace.drops_edits = true;
    drop(paths);
    model.workspace.drops_edits = false;
}

/// Reads changed files again. Edits of the set-up are never lost that way.
void Window::take_changed_files(double now) {
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
    open_job();
    say(model, "A file has changed: reloading", now);
}

/// Carries out the requests about the set-up, and checks the program again after an edit.
void Window::update_setup(double now) {
    constexpr double keep_delay = 1.0; // seconds
    Workspace& workspace = model.workspace;
    const bool saves = std::exchange(model.wants_saving, false) || !model.save_path.empty();
    if (saves && check_) {
        const std::string before = workspace.document.path();
        if (!save_document(model, std::exchange(model.save_path, {}), job_.write, now)) {
            // The browser says why a name was refused; the dialog of the system cannot.
            if (workspace.is_naming && model.popup != Popup::open_file)
                (workspace.refusal.empty() ? browse : browse_here)(model, FileWish::save_setup, {});
        } else {
            if (model.popup == Popup::open_file) model.popup = Popup::none;
            unsaved_.forget(check_->program, before);
            keep_unsaved_at_.reset();
            check_->setup = workspace.document.path();
            watch_files();
            if (workspace.document.path() != before) open_job();
            if (workspace.leaving != Leaving::no) leave();
        }
        damage();
    }
    if (std::exchange(workspace.drops_edits, false)) leave();
    if (std::exchange(workspace.forgets_found, false) && check_)
        unsaved_.forget(check_->program, workspace.document.path());
    if (check_ && workspace.document.version() != opened_version_) {
        open_job();
        keep_unsaved_at_ = now + keep_delay;
    }
    if (!keep_unsaved_at_ || now < *keep_unsaved_at_ || !check_) return;
    keep_unsaved_at_.reset();
    const SetupDocument& document = workspace.document;
    if (document.is_modified())
        unsaved_.keep(check_->program, document.path(), document.text());
    else
        unsaved_.forget(check_->program, document.path());
}

void Window::press(int code, int modifiers) {
    log_.key(code);
    damage();
    const auto command = command_of(code, modifiers);
    if (!command) return;
    // WantTextInput stays set for two frames after its field is gone.
    const bool is_typing = ImGui::GetIO().WantTextInput && ImGui::IsAnyItemActive();
    const bool is_plain = code < key::escape && (modifiers & mod::control) == 0;
    const bool moves_text = code >= key::enter && code <= key::end;
    if (is_typing && (is_plain || moves_text)) return;
    const bool keeps_keys = (model.popup != Popup::none && model.popup != Popup::shortcuts)
                            || (model.popup == Popup::none && model.workspace.has_keys);
    const bool closes = *command == Command::close_popup || *command == Command::what_if
                        || *command == Command::quit;
    if (keeps_keys && !closes && (is_plain || moves_text)) return;
    perform(model, *command, glfwGetTime());
}

void Window::set_title() {
    const std::string title = window_title(model);
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::save_picture() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    const std::filesystem::path path = free_picture_name(job_.pictures);
    const auto written = render::write_png(screen_picture(width, height), path);
    say(model, written ? "Saved " + path.generic_string() : written.error().message, glfwGetTime());
    damage();
}

void Window::update() {
    const double now = glfwGetTime();
    SessionUpdate news = worker_.take();
    if (news.has_news) damage();
    take_in(model, std::move(news), now);
    DeviceUpdate answers = device_.take();
    if (answers.has_news) damage();
    take_in(model, std::move(answers));
    ToleranceUpdate found = tolerances_.take();
    if (found.has_news) damage();
    take_in(model, std::move(found));
    if (play(model, std::min(now - last_frame_, 0.2))) damage();
    last_frame_ = now;
    if (take_in(model, folders_.take())) damage();
    if (!model.unwanted_recent.empty()) {
        recent_.remove(std::exchange(model.unwanted_recent, {}));
        model.recent = recent_.programs();
    }
    take_answer();
    ask_system_dialog();
    remember_opened();
    if (std::exchange(model.wants_back, false)) go_back();
    if (!model.wanted_paths.empty()) drop(std::exchange(model.wanted_paths, {}));
    if (send_browser_orders(model, folders_, now)) read_recent();
    if (std::exchange(model.wants_reload, false)) open_job();
    if (now - last_watch_ > watch_interval) {
        last_watch_ = now;
        if (files_.has_changed()) take_changed_files(now);
        if (model.missing != files_.missing()) {
            model.missing = files_.missing();
            damage();
        }
        if (now < model.message_until + watch_interval) damage();
    }
    update_setup(now);
    if (send_device_orders(model, device_, check_)) damage();
    if (send_tolerance_orders(model, tolerances_, check_)) damage();
    if (send_requests(model, worker_)) {
        asked_ = true;
        damage();
    }
    if (std::exchange(model.notes_changed, false))
        keep_notes(model, job_.notes_file, job_.write, now);
    if (std::exchange(model.wants_quit, false)) close();
}

void Window::draw() {
    log_.begin_frame();
    rebuild_fonts();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    if (keys_.feed(ImGui::GetIO())) damage();
    ImGui::NewFrame();
    layout_.draw(model, fonts_, glfwGetTime());
    set_title();
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    const ImVec4 back = Theme{model.settings.theme}.vector(render::Role::panel);
    glClearColor(back.x, back.y, back.z, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (model.wants_picture && std::exchange(model.wants_picture, false)) save_picture();
    glfwSwapBuffers(window_);
    log_.end_frame(model);
}

void Window::remember_geometry() {
    Settings& settings = model.settings;
    settings.maximised = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) == GLFW_TRUE;
    if (settings.maximised) return;
    glfwGetWindowSize(window_, &settings.width, &settings.height);
    glfwGetWindowPos(window_, &settings.x, &settings.y);
}

void Window::run() {
    if (check_) open(*check_);
    while (glfwWindowShouldClose(window_) == GLFW_FALSE) {
        update();
        if (std::exchange(asked_, false) && !model.playback.running) {
            glfwWaitEventsTimeout(answer_time);
            update();
        }
        if (frames_ > 0) {
            --frames_;
            draw();
        }
        if (model.playback.running)
            glfwWaitEventsTimeout(frame_time);
        else if (frames_ > 0 || model.wanted)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(watch_interval);
    }
    remember_geometry();
    write_settings(model.settings, job_.settings_file);
}

Window& window_of(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

/// Redraws the window after any event.
template <typename... What>
void damage(GLFWwindow* window, What...) {
    if (glfwGetWindowUserPointer(window)) window_of(window).damage();
}

void listen(GLFWwindow* window) {
    glfwSetWindowCloseCallback(window, [](GLFWwindow* w) {
        if (!glfwGetWindowUserPointer(w)) return;
        glfwSetWindowShouldClose(w, GLFW_FALSE);
        window_of(w).close();
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        if (glfwGetWindowUserPointer(w))
            window_of(w).drop(std::vector<std::string>(paths, paths + count));
    });
    glfwSetCursorPosCallback(window, damage<double, double>);
    glfwSetMouseButtonCallback(window, damage<int, int, int>);
    glfwSetScrollCallback(window, damage<double, double>);
    glfwSetCharCallback(window, damage<unsigned>);
    glfwSetFramebufferSizeCallback(window, damage<int, int>);
    glfwSetWindowRefreshCallback(window, damage<>);
    glfwSetWindowFocusCallback(window, damage<int>);
}

/// Replaces the key callback of ImGui's backend.
void listen_to_keys(GLFWwindow* window) {
    glfwSetKeyCallback(window, [](GLFWwindow* w, int code, int, int action, int modifiers) {
        if (!glfwGetWindowUserPointer(w)) return;
        window_of(w).damage();
        // The system repeats keys, and reports fast presses as repeats.
        if (action == GLFW_REPEAT) window_of(w).type(code, false);
        window_of(w).type(code, action != GLFW_RELEASE);
        const int known = mod::shift | mod::control | mod::alt;
        if (action != GLFW_RELEASE) window_of(w).press(code, modifiers & known);
    });
}

struct CloseWindow {
    void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using OpenWindow = std::unique_ptr<GLFWwindow, CloseWindow>;

OpenWindow make_window(const Settings& settings) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SAMPLES, 0);
    glfwWindowHint(GLFW_MAXIMIZED, settings.maximised ? GLFW_TRUE : GLFW_FALSE);
    OpenWindow window(
        glfwCreateWindow(settings.width, settings.height, "feeler", nullptr, nullptr));
    if (!window) return window;
    if (settings.x >= 0 && settings.y >= 0) glfwSetWindowPos(window.get(), settings.x, settings.y);
    glfwSetWindowSizeLimits(window.get(), 640, 420, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(window.get());
    glfwSwapInterval(1);
    listen(window.get());
    return window;
}

} // namespace

core::Result<void> run_window(const WindowJob& job) {
    const Glfw glfw;
    if (!glfw.is_open) return core::fail(core::ErrorCode::unsupported, "there is no display");
    const Settings settings = read_settings(job.settings_file);
    const OpenWindow window = make_window(settings);
    if (!window)
        return core::fail(core::ErrorCode::unsupported, "OpenGL 3.3 is not available for a window");
    FEELER_TRY(render::Renderer renderer, render::Renderer::make());
    const auto shown = std::make_unique<Window>(job, window.get(), std::move(renderer));
    shown->model.settings = settings;
    shown->model.device.file = job.device.file;
    shown->model.device.shown = job.device.shown;
    shown->model.browser.uses_system =
        settings.system_dialog
        && core::platform::environment_variable("FEELER_FILE_DIALOG") != "own";
    shown->model.samples = samples_folder().generic_string();
    shown->model.notes = notes_in(core::file_bytes(job.notes_file).value_or(""));
    listen_to_keys(window.get());
    glfwSetWindowUserPointer(window.get(), shown.get());
    core::platform::close_own_console(); // from here on, the window shows what there is to say
    shown->run();
    glfwSetWindowUserPointer(window.get(), nullptr);
    return {};
}

namespace {

double now() {
    using namespace std::chrono;
    return duration<double>(system_clock::now().time_since_epoch()).count();
}

} // namespace

FrameLog::FrameLog(const std::filesystem::path& path) {
    if (!path.empty()) file_.open(path);
}

void FrameLog::key(int code) {
    if (file_.is_open()) file_ << fmt::format("key {:.4f} {}\n", now(), code) << std::flush;
}

void FrameLog::begin_frame() { begin_ = now(); }

void FrameLog::end_frame(const ViewModel& model) {
    if (!file_.is_open()) return;
    const long shown = model.block_state ? static_cast<long>(model.block_state->block) : -1L;
    const size_t points = model.path ? model.path->points.size() : 0;
    file_ << fmt::format("frame {:.4f} {:.4f} {} {} {}\n", begin_, now(), model.cursor.block, shown,
                         points)
          << std::flush;
}

void KeyQueue::add(int code, bool is_down) {
    if (code >= 0 && code < IM_ARRAYSIZE(ImGuiIO::KeysDown)) keys_.emplace_back(code, is_down);
}

bool KeyQueue::feed(ImGuiIO& io) {
    std::set<int> changed;
    bool has_press = false;
    while (!keys_.empty() && (keys_.front().second || !has_press)
           && changed.insert(keys_.front().first).second) {
        has_press = has_press || keys_.front().second;
        io.KeysDown[keys_.front().first] = keys_.front().second;
        keys_.pop_front();
    }
    io.KeyCtrl = io.KeysDown[key::left_control] || io.KeysDown[key::right_control];
    io.KeyShift = io.KeysDown[key::left_shift] || io.KeysDown[key::right_shift];
    io.KeyAlt = io.KeysDown[key::left_alt] || io.KeysDown[key::right_alt];
    return !keys_.empty();
}

render::Image screen_picture(int width, int height) {
    render::Image image{width, height, {}};
    const size_t row = 4 * static_cast<size_t>(width);
    std::vector<uint8_t> pixels(row * static_cast<size_t>(height));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    for (size_t y = static_cast<size_t>(height); y-- > 0;)
        image.rgba.insert(image.rgba.end(), pixels.begin() + static_cast<ptrdiff_t>(y * row),
                          pixels.begin() + static_cast<ptrdiff_t>((y + 1) * row));
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
}

std::filesystem::path free_picture_name(const std::filesystem::path& folder) {
    std::filesystem::path path;
    for (int number = 1; number < 10000; ++number) {
        path = folder / fmt::format("feeler-{:04}.png", number);
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) break;
    }
    return path;
}

} // namespace app::viewer
