#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/view/model/file_browser.h"

struct GLFWwindow;

namespace app::viewer {

/// A question for the file dialog of the system.
struct DialogJob {
    FileWish wish{};
    std::string title;
    std::string folder;   // where it begins; empty: left to the system
    std::string name;     // of the file to be saved
    uintptr_t window = 0; // to which the dialog belongs: X11 window or HWND; 0: unknown
};

/// The answer.
struct DialogUpdate {
    uint64_t run = 0;                // number of the job
    bool is_absent = false;          // the system has no dialog
    std::optional<std::string> path; // chosen; empty: the user has cancelled
    bool has_news = false;
};

/// Asks the system for a file and waits for the answer of the user, or until `is_over`. `run` of
/// the answer is not set.
///
/// On Linux through the portal of the desktop, org.freedesktop.portal.FileChooser, with a libdbus
/// that is loaded when it is first needed: without it, or without a portal, there is no dialog. On
/// Windows through the common item dialog.
DialogUpdate ask_system(const DialogJob& job, const std::function<bool()>& is_over);

/// Asks in a separate thread, so that the window is drawn meanwhile.
class SystemDialog {
public:
    /// `wake` is called from the thread when there is an answer.
    explicit SystemDialog(std::function<void()> wake);
    /// Abandons the question.
    ~SystemDialog();

    /// Asks, and abandons an earlier question. Returns the number of the job, above 0.
    uint64_t start(DialogJob job);
    /// The answer, if it has come since the last call.
    DialogUpdate take();

private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

/// The window as the system knows it, for DialogJob; 0 if it is of another kind.
uintptr_t native_window(GLFWwindow* window);

/// The path of a `file:` URI; empty for another one.
std::optional<std::string> path_of_uri(const std::string& uri);

} // namespace app::viewer
