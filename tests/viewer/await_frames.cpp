// Waits until a window has drawn what it was told so far: await_frames WINDOW COUNT. It asks the
// window COUNT times, as a window manager does, whether it is alive (_NET_WM_PING). A window
// answers after it has taken in all events before the question, and takes in events once for each
// frame.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <X11/Xlib.h>

namespace {

struct Question {
    Display* display = nullptr;
    Window window = 0;
    Atom protocols = 0, ping = 0;
};

void ask(const Question& question, long number) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = question.window;
    event.xclient.message_type = question.protocols;
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(question.ping);
    event.xclient.data.l[1] = number;
    event.xclient.data.l[2] = static_cast<long>(question.window);
    XSendEvent(question.display, question.window, False, NoEventMask, &event);
    XFlush(question.display);
}

/// False where no answer comes within two minutes.
bool has_answer(const Question& question, long number) {
    using namespace std::chrono_literals;
    const auto end = std::chrono::steady_clock::now() + 120s; // clock: gives up after 2 min
    while (std::chrono::steady_clock::now() < end) {          // clock: as above
        if (XPending(question.display) == 0) {
            std::this_thread::sleep_for(2ms); // clock: polls
            continue;
        }
        XEvent event;
        XNextEvent(question.display, &event);
        if (event.type == ClientMessage && event.xclient.message_type == question.protocols
            && static_cast<Atom>(event.xclient.data.l[0]) == question.ping
            && event.xclient.data.l[1] == number)
            return true;
    }
    return false;
}

/// A window that goes meanwhile is no matter here.
int ignore(Display* /*display*/, XErrorEvent* /*error*/) { return 0; }

} // namespace

int main(int count, char** words) {
    Question question;
    question.display = XOpenDisplay(nullptr);
    if (count != 3 || !question.display) return 2;
    XSetErrorHandler(ignore);
    question.window = std::strtoul(words[1], nullptr, 0);
    question.protocols = XInternAtom(question.display, "WM_PROTOCOLS", False);
    question.ping = XInternAtom(question.display, "_NET_WM_PING", False);
    XSelectInput(question.display, DefaultRootWindow(question.display), SubstructureNotifyMask);
    for (long number = 1; number <= std::atol(words[2]); ++number) {
        ask(question, number);
        if (has_answer(question, number)) continue;
        std::fprintf(stderr, "await_frames: the window does not answer\n");
        return 1;
    }
    XCloseDisplay(question.display);
    return 0;
}
