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

#include "app/base/text.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/folder_listing.h"
#include "app/view/model/navigation.h"
#include "app/view/model/open_programs.h"
#include "app/view/model/recent_files.h"
#include "app/view/model/samples.h"
#include "app/view/model/settings.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/command.h"
#include "app/view/ui/imgui_backends.h"
#include "app/view/ui/panels.h"
#include "app/view/ui/program_tab.h"
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

/// Whether a key moves the focus to where the characters that follow belong.
bool moves_focus(int code) {
    return code == key::tab || code == key::enter || code == key::insert
           || code == key::function(2);
}

/// A queue of key events and characters for ImGui 1.86, which only sees whether a key is down
/// during a frame.
///
/// A key that is pressed and released between two frames gets one frame for each event. A modifier
/// released after a key press still counts as down in the frame of that press. A key
/// such as Tab needs two more frames to move to another field: characters wait until then, or the
/// sign of a number that is typed fast would be lost. A field that a command asks for, such as the
/// filter, may need more: a dialog that closes takes the keyboard back first.
class KeyQueue {
public:
    /// Adds an event of a key with this GLFW code.
    void add(int code, bool is_down);
    /// Adds a character that was typed.
    void add_character(unsigned character);
    /// Whether characters wait for a frame. A command must then wait, too: see add_command().
    bool has_characters() const;
    /// Whether the focus is about to move. A key that may be meant as a character must then wait.
    bool moves_now() const;
    /// A field is to get the focus: what is typed now waits until it has it, for half a second of
    /// frames at most.
    void await_field();
    /// That field has the focus.
    void field_has_focus();
    /// Whether what is typed waits now.
    bool is_waiting() const { return frames_to_wait_ > 0; }
    /// Adds the command of a key with modifiers, to be taken after the frames of all that waits.
    void add_command(int code, int modifiers);
    /// The command that is due before the next frame, as code and modifiers.
    std::optional<std::pair<int, int>> take_command();

    /// Passes ImGui the events for the next frame. True if some are left for later frames.
    bool feed(ImGuiIO& io);

private:
    struct Event {
        int code = 0;
        bool is_down = false;
        unsigned character = 0;  // if it is not 0, this is no event of a key
        bool is_command = false; // of `code` and `modifiers`
        int modifiers = 0;
    };
    bool may_feed(const std::set<int>& changed, bool has_press, bool has_character) const;

    static constexpr int frames_of_a_move = 2;
    std::deque<Event> events_;
    int frames_to_wait_ = 0;
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

/// Whether a command has asked for a field that does not have the keyboard yet.
bool awaits_field(const ViewModel& model) {
    return model.filter_wants_focus || model.note_wants_focus;
}

/// Interval between checks of the files, and longest sleep of the window, seconds.
constexpr double watch_interval = 0.4;
constexpr double frame_time = 1.0 / 60.0;
/// Typical time to make the view of a block, seconds. After a step the window waits this long, to
/// draw one frame instead of two.
constexpr double answer_time = 0.015;
/// Open programs at a time. Each keeps its record and the model of its stock.
constexpr size_t most_tabs = 20;

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
    Window(const WindowJob& job, GLFWwindow* window, const Settings& settings)
        : job_(job),
          window_(window),
          gui_(window),
          recent_(job.recent_file, job.write),
          log_(job.frame_log),
          folders_(wake),
          dialog_(wake) {
        start_.settings = settings;
        start_.recent = recent_.programs();
    }

    core::Result<void> run();
    void press(int code, int modifiers);
    void type(int code, bool is_down) { keys_.add(code, is_down); }
    void type_character(unsigned character) { keys_.add_character(character); }
    void drop(const std::vector<std::string>& paths);
    void damage() { frames_ = 3; }
    /// Closes, or asks first if there are unsaved edits.
    void ask_to_close();

private:
    static void wake() { glfwPostEmptyEvent(); }

    ProgramTab& tab() { return *tabs_[shown_]; }
    ViewModel& shown_model() { return tab().model; }

    void update();
    void draw();
    void rebuild_fonts();
    void save_picture();
    void perform_key(int code, int modifiers);
    void open(const CheckJob& check);
    core::Result<void> add_tab(size_t index);
    void show_tab(size_t index);
    void close_tab(size_t index);
    void ask_to_close_tab(size_t index);
    void take_turns();
    void list_tabs();
    void remember_opened();
    void read_recent();
    void ask_system_dialog();
    void take_answer();
    void update_setup(double now);
    void leave();
    void close();
    void remember_geometry();
    void set_title();
    void follow_focus(ViewModel& model);
    double wanted_scale() const;

    const WindowJob& job_;
    ViewModel start_; // of a window without programs: settings and files
    std::vector<std::unique_ptr<ProgramTab>> tabs_; // in the order of their tabs; never empty
    size_t shown_ = 0;
    const ProgramTab* shown_before_ = nullptr;
    RecentProgram remembered_; // in the list of recent programs
    GLFWwindow* window_;
    Gui gui_;
    Fonts fonts_;
    std::string title_;
    std::optional<render::ColorScheme> styled_;
    RecentFiles recent_;
    FrameLog log_;
    KeyQueue keys_;
    double last_watch_ = 0.0, last_frame_ = 0.0;
    int frames_ = 3; // still to draw: ImGui needs several to settle the layout
    FolderWorker folders_;
    SystemDialog dialog_;
    uint64_t asked_dialog_ = 0; // number of the question
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
           * tabs_[shown_]->model.settings.scale;
}

void Window::rebuild_fonts() {
    const double scale = wanted_scale();
    const render::ColorScheme theme = shown_model().settings.theme;
    if (fonts_.text && fonts_.scale == scale && styled_ == theme) return;
    if (!fonts_.text || fonts_.scale != scale) {
        fonts_ = load_fonts(scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
    apply_style(Theme{theme}, scale);
    styled_ = theme;
}

/// Adds an empty place for a program and shows it.
core::Result<void> Window::add_tab(size_t index) {
    FEELER_TRY(render::Renderer renderer, render::Renderer::make());
    auto added = std::make_unique<ProgramTab>(job_, std::move(renderer), wake);
    show_in_place(added->model, tabs_.empty() ? start_ : shown_model());
    if (!tabs_.empty()) shown_before_ = &tab();
    tabs_.insert(tabs_.begin() + static_cast<ptrdiff_t>(index), std::move(added));
    shown_ = index;
    return {};
}

void Window::show_tab(size_t index) {
    damage();
    if (index >= tabs_.size() || index == shown_) return;
    if (shown_model().workspace.is_typing) { // what is typed belongs to the shown program
        shown_model().workspace.commits_typed = true;
        shown_model().wanted_tab = index;
        return;
    }
    tab().keep_edits();
    show_in_place(tabs_[index]->model, shown_model());
    shown_before_ = &tab();
    shown_ = index;
    last_watch_ = 0.0; // its files may have changed meanwhile
}

/// Closes a program. The one that was shown before it is shown then.
void Window::close_tab(size_t index) {
    damage();
    if (index >= tabs_.size()) return;
    const auto before = std::find_if(tabs_.begin(), tabs_.end(), [&](const auto& each) {
        return each.get() == shown_before_ && each != tabs_[index];
    });
    if (index == shown_) {
        if (tabs_.size() == 1 && !add_tab(1)) return;
        show_tab(before != tabs_.end()      ? static_cast<size_t>(before - tabs_.begin())
                 : index + 1 < tabs_.size() ? index + 1
                                            : index - 1);
    }
    if (shown_before_ == tabs_[index].get()) shown_before_ = nullptr;
    tabs_.erase(tabs_.begin() + static_cast<ptrdiff_t>(index));
    if (shown_ > index) --shown_;
}

void Window::ask_to_close_tab(size_t index) {
    if (index >= tabs_.size()) return;
    if (!tabs_[index]->model.workspace.document.is_modified()) return close_tab(index);
    show_tab(index);
    shown_model().workspace.leaving = Leaving::to_close_tab;
    shown_model().popup = Popup::leaving;
}

/// Opens a program in a tab of its own; one that is open is shown.
void Window::open(const CheckJob& check) {
    const std::string path = absolute_path(check.program);
    const auto known = std::find_if(tabs_.begin(), tabs_.end(), [&](const auto& each) {
        return each->check() && absolute_path(each->check()->program) == path;
    });
    if (known == tabs_.end()) {
        if (tab().is_vacant()) {
            const size_t index = shown_;
            if (tab().check() && add_tab(index + 1)) close_tab(index);
        } else if (tabs_.size() >= most_tabs) {
            return say(shown_model(), "Close a program first: as many are open as there can be",
                       glfwGetTime());
        } else if (const auto added = add_tab(shown_ + 1); !added) {
            return say(shown_model(), added.error().message, glfwGetTime());
        }
        return tab().open(check);
    }
    show_tab(static_cast<size_t>(known - tabs_.begin()));
    Workspace& workspace = shown_model().workspace;
    const std::string& setup = workspace.document.path();
    const bool is_same = check.setup.empty() || absolute_path(check.setup) == absolute_path(setup);
    if (is_same && !tab().is_vacant()) return;
    if (!workspace.document.is_modified() || workspace.drops_edits) return tab().open(check);
    workspace.leaving = Leaving::to_open;
    workspace.leaving_for = {check.program, check.setup};
    shown_model().popup = Popup::leaving;
}

/// Lets the other programs be checked once the shown one is, one after the other.
void Window::take_turns() {
    bool is_busy = tab().is_checking();
    for (const auto& each : tabs_) {
        if (each.get() == &tab()) {
            each->rest(false);
            continue;
        }
        each->rest(is_busy);
        is_busy = is_busy || each->is_checking();
    }
}

/// Gives the shown model the titles of all tabs.
void Window::list_tabs() {
    std::vector<const ViewModel*> models;
    models.reserve(tabs_.size());
    for (const auto& each : tabs_) models.push_back(&each->model);
    std::vector<TabTitle> titles = tab_titles(models);
    ViewModel& model = shown_model();
    if (titles != model.tabs || model.shown_tab != shown_) damage();
    model.tabs = std::move(titles);
    model.shown_tab = shown_;
}

/// Shows what other windows have added to the list of recent programs.
void Window::read_recent() {
    recent_.read();
    ViewModel& model = shown_model();
    if (model.recent == recent_.programs()) return;
    model.recent = recent_.programs();
    damage();
}

/// Opens the file dialog of the system, if that is requested.
void Window::ask_system_dialog() {
    FileBrowser& browser = shown_model().browser;
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
    ViewModel& model = shown_model();
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
    model.workspace.may_replace = saves(browser.wish);
    choose_file(model, *answer.path);
}

/// Puts the shown program into the list of recent ones.
void Window::remember_opened() {
    ViewModel& model = shown_model();
    const bool is_open = tab().check() && model.program && model.has_rows() && !model.failure
                         && model.program->program == tab().check()->program;
    if (!is_open) return;
    RecentProgram opened{tab().check()->program, model.workspace.document.path()};
    if (opened == remembered_) return;
    recent_.add(opened.program, opened.setup);
    model.recent = recent_.programs();
    remembered_ = std::move(opened);
}

void Window::drop(const std::vector<std::string>& paths) {
    damage();
    ViewModel& model = shown_model();
    if (!can_open(paths, model, glfwGetTime())) return;
    const std::vector<CheckJob> checks =
        dropped_programs(tab().check().value_or(CheckJob{}), paths, model, glfwGetTime());
    for (const CheckJob& check : checks) open(check);
}

void Window::ask_to_close() {
    if (shown_model().workspace.is_typing) {
        shown_model().workspace.commits_typed = shown_model().wants_quit = true;
        return damage();
    }
    for (const auto& each : tabs_) each->may_drop = false;
    close();
}

/// Closes if no program has unsaved edits that the user has not agreed to drop.
void Window::close() {
    for (size_t i = 0; i < tabs_.size(); ++i) {
        if (tabs_[i]->may_drop || !tabs_[i]->model.workspace.document.is_modified()) continue;
        show_tab(i);
        shown_model().workspace.leaving = Leaving::to_close;
        shown_model().popup = Popup::leaving;
        return damage();
    }
    for (const auto& each : tabs_)
        if (each->may_drop) each->forget_edits();
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

/// Does what the user wanted to do when edits were not saved, after they were saved or dropped.
void Window::leave() {
    Workspace& workspace = shown_model().workspace;
    const Leaving leaving = std::exchange(workspace.leaving, Leaving::no);
    const std::vector<std::string> paths = std::exchange(workspace.leaving_for, {});
    if (leaving == Leaving::to_close) {
        tab().may_drop = true;
        return close();
    }
    tab().forget_edits();
    if (leaving == Leaving::to_close_tab) return close_tab(shown_);
    workspace.drops_edits = true;
    drop(paths);
    shown_model().workspace.drops_edits = false;
}

/// Carries out the requests about the set-up, and checks the program again after an edit.
void Window::update_setup(double now) {
    if (tab().save_if_wanted(now)) {
        damage();
        if (shown_model().workspace.leaving != Leaving::no) leave();
    }
    if (std::exchange(shown_model().workspace.drops_edits, false)) leave();
    tab().make_sheet_if_wanted(now);
    if (tab().read_job_file_if_wanted(now)) damage();
    tab().take_edits(now);
}

void Window::press(int code, int modifiers) {
    log_.key(code);
    damage();
    const bool may_be_typed = code < key::escape && (modifiers & mod::control) == 0;
    // In a dialog, keys before this one may still wait for a frame, such as Enter, which closes it.
    const bool has_dialog = shown_model().popup != Popup::none;
    if (keys_.has_characters() || has_dialog || (may_be_typed && keys_.moves_now()))
        keys_.add_command(code, modifiers);
    else
        perform_key(code, modifiers);
}

void Window::perform_key(int code, int modifiers) {
    const auto command = command_of(code, modifiers);
    if (!command) return;
    // WantTextInput stays set for two frames after its field is gone.
    const bool is_typing = ImGui::GetIO().WantTextInput && ImGui::IsAnyItemActive();
    const bool has_control = (modifiers & mod::control) != 0;
    const bool is_plain = code < key::escape && !has_control;
    const bool changes_tab =
        has_control && (code == key::tab || code == key::page_up || code == key::page_down);
    const bool moves_text = code >= key::enter && code <= key::end && !changes_tab;
    if (is_typing && (is_plain || moves_text)) return;
    ViewModel& model = shown_model();
    // Esc leaves a field or a list first, and in a field undo is about what is typed there.
    const bool is_list_open = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    if (*command == Command::close_popup && model.popup == Popup::none
        && (is_typing || is_list_open))
        return;
    const bool undoes = *command == Command::undo || *command == Command::redo;
    if (undoes && model.workspace.is_typing) return;
    const bool closes = *command == Command::close_popup || *command == Command::what_if
                        || *command == Command::quit;
    const bool popup_keeps =
        model.popup != Popup::none && model.popup != Popup::shortcuts && (is_plain || moves_text);
    // The set-up panel keeps the keys that move in it.
    const bool moves = (moves_text && !has_control) || code == key::space || is_list_open;
    const bool panel_keeps =
        model.popup == Popup::none && model.workspace.has_keys && moves && (is_plain || moves_text);
    if ((popup_keeps || panel_keeps) && !closes) return;
    perform(model, *command, glfwGetTime());
    if (awaits_field(model)) keys_.await_field();
}

void Window::set_title() {
    const std::string title = window_title(shown_model());
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::save_picture() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    const std::filesystem::path path = free_picture_name(job_.pictures);
    const auto written = render::write_png(screen_picture(width, height), path);
    say(shown_model(), written ? "Saved " + path.generic_string() : written.error().message,
        glfwGetTime());
    damage();
}

void Window::update() {
    const double now = glfwGetTime();
    for (const auto& each : tabs_)
        if (each->take_updates(now) && each.get() == &tab()) damage();
    {
        ViewModel& model = shown_model();
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
        if (const auto wanted = std::exchange(model.wanted_tab, {})) show_tab(*wanted);
    }
    // Another program may be shown from here on.
    if (const auto unwanted = std::exchange(shown_model().unwanted_tab, {}))
        ask_to_close_tab(*unwanted);
    if (!shown_model().wanted_paths.empty()) drop(std::exchange(shown_model().wanted_paths, {}));
    if (send_browser_orders(shown_model(), folders_, now)) read_recent();
    if (std::exchange(shown_model().wants_reload, false)) tab().reload();
    if (now - last_watch_ > watch_interval) {
        last_watch_ = now;
        for (const auto& each : tabs_)
            if (each->take_changed_files(now)) damage();
        if (now < shown_model().message_until + watch_interval) damage();
    }
    update_setup(now);
    take_turns();
    list_tabs();
    if (tab().send_orders()) damage();
    if (std::exchange(shown_model().notes_changed, false))
        keep_notes(shown_model(), job_.notes_file, job_.write, now);
    if (std::exchange(shown_model().wants_quit, false)) ask_to_close();
    if (shown_model().workspace.commits_typed) damage();
}

/// After a frame in which a field was to get the keyboard.
void Window::follow_focus(ViewModel& model) {
    if (!awaits_field(model)) return keys_.field_has_focus();
    damage();
    if (!keys_.is_waiting()) model.filter_wants_focus = model.note_wants_focus = false;
}

void Window::draw() {
    log_.begin_frame();
    rebuild_fonts();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    while (const auto command = keys_.take_command()) perform_key(command->first, command->second);
    if (keys_.feed(ImGui::GetIO())) damage();
    // Enter presses the button that has the focus, as Space does.
    if (!ImGui::GetIO().WantTextInput && ImGui::GetIO().KeysDown[key::enter])
        ImGui::GetIO().NavInputs[ImGuiNavInput_Activate] = 1.0F;
    ImGui::NewFrame();
    ViewModel& model = shown_model();
    const bool was_awaited = awaits_field(model);
    tab().layout.draw(model, fonts_, glfwGetTime());
    if (was_awaited) follow_focus(model);
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
    Settings& settings = shown_model().settings;
    settings.maximised = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) == GLFW_TRUE;
    if (settings.maximised) return;
    glfwGetWindowSize(window_, &settings.width, &settings.height);
    glfwGetWindowPos(window_, &settings.x, &settings.y);
}

core::Result<void> Window::run() {
    start_.browser.uses_system =
        start_.settings.system_dialog
        && core::platform::environment_variable("FEELER_FILE_DIALOG") != "own";
    start_.samples = samples_folder().generic_string();
    start_.notes = notes_in(core::file_bytes(job_.notes_file).value_or(""));
    if (auto added = add_tab(0); !added) return added;
    glfwSetWindowUserPointer(window_, this);
    for (const auto& check : job_.checks) open(*check);
    show_tab(0);
    while (glfwWindowShouldClose(window_) == GLFW_FALSE) {
        update();
        if (tab().has_asked() && !shown_model().playback.running) {
            glfwWaitEventsTimeout(answer_time);
            update();
        }
        if (frames_ > 0) {
            --frames_;
            draw();
        }
        if (shown_model().playback.running)
            glfwWaitEventsTimeout(frame_time);
        else if (frames_ > 0 || shown_model().wanted)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(watch_interval);
    }
    glfwSetWindowUserPointer(window_, nullptr);
    remember_geometry();
    write_settings(shown_model().settings, job_.settings_file);
    return {};
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
        window_of(w).ask_to_close();
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        if (glfwGetWindowUserPointer(w))
            window_of(w).drop(std::vector<std::string>(paths, paths + count));
    });
    glfwSetCursorPosCallback(window, damage<double, double>);
    glfwSetMouseButtonCallback(window, damage<int, int, int>);
    glfwSetScrollCallback(window, damage<double, double>);
    glfwSetFramebufferSizeCallback(window, damage<int, int>);
    glfwSetWindowRefreshCallback(window, damage<>);
    glfwSetWindowFocusCallback(window, damage<int>);
}

/// Replaces the callbacks of ImGui's backend for keys and characters.
void listen_to_keys(GLFWwindow* window) {
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
        if (!glfwGetWindowUserPointer(w)) return;
        window_of(w).damage();
        window_of(w).type_character(character);
    });
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
    const auto shown = std::make_unique<Window>(job, window.get(), settings);
    listen_to_keys(window.get());
    core::platform::close_own_console(); // from here on, the window shows what there is to say
    return shown->run();
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
    if (code >= 0 && code < IM_ARRAYSIZE(ImGuiIO::KeysDown)) events_.push_back({code, is_down});
}

void KeyQueue::add_character(unsigned character) { events_.push_back({.character = character}); }

bool KeyQueue::has_characters() const {
    return std::any_of(events_.begin(), events_.end(),
                       [](const Event& event) { return event.character != 0 || event.is_command; });
}

bool KeyQueue::moves_now() const {
    return frames_to_wait_ > 0
           || std::any_of(events_.begin(), events_.end(), [](const Event& event) {
                  return event.is_down && moves_focus(event.code);
              });
}

void KeyQueue::await_field() { frames_to_wait_ = 30; }

void KeyQueue::field_has_focus() { frames_to_wait_ = std::min(frames_to_wait_, frames_of_a_move); }

void KeyQueue::add_command(int code, int modifiers) {
    events_.push_back({.code = code, .is_command = true, .modifiers = modifiers});
}

std::optional<std::pair<int, int>> KeyQueue::take_command() {
    if (events_.empty() || !events_.front().is_command || frames_to_wait_ > 0) return {};
    const Event event = events_.front();
    events_.pop_front();
    return std::pair{event.code, event.modifiers};
}

/// Whether the next event fits into a frame in which these keys have changed. ImGui drops
/// characters of a frame in which Ctrl is down.
bool KeyQueue::may_feed(const std::set<int>& changed, bool has_press, bool has_character) const {
    if (events_.empty() || frames_to_wait_ > 0) return false;
    const Event& next = events_.front();
    if (next.is_command) return false;
    if (next.character != 0) return true;
    const bool fits = next.is_down ? !has_character : !has_press;
    return fits && !changed.contains(next.code);
}

bool KeyQueue::feed(ImGuiIO& io) {
    std::set<int> changed;
    bool has_press = false, has_character = false;
    if (frames_to_wait_ > 0) --frames_to_wait_;
    while (may_feed(changed, has_press, has_character)) {
        const Event event = events_.front();
        events_.pop_front();
        if (event.character != 0) {
            io.AddInputCharacter(event.character);
            has_character = true;
            continue;
        }
        has_press = has_press || event.is_down;
        changed.insert(event.code);
        io.KeysDown[event.code] = event.is_down;
        if (event.is_down && moves_focus(event.code)) frames_to_wait_ = frames_of_a_move;
    }
    io.KeyCtrl = io.KeysDown[key::left_control] || io.KeysDown[key::right_control];
    io.KeyShift = io.KeysDown[key::left_shift] || io.KeysDown[key::right_shift];
    io.KeyAlt = io.KeysDown[key::left_alt] || io.KeysDown[key::right_alt];
    return !events_.empty();
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
