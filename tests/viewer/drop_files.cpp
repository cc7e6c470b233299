// Drops files on a window, as a file manager does (XDND, version 5): drop_files WINDOW X Y PATH...
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace {

struct Source {
    Display* display = nullptr;
    Window own = 0, target = 0;
    std::string uris;

    Atom atom(const char* name) const { return XInternAtom(display, name, False); }
};

void send(const Source& source, const char* kind, long a, long b, long c, long d) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = source.target;
    event.xclient.message_type = source.atom(kind);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(source.own);
    event.xclient.data.l[1] = a;
    event.xclient.data.l[2] = b;
    event.xclient.data.l[3] = c;
    event.xclient.data.l[4] = d;
    XSendEvent(source.display, source.target, False, NoEventMask, &event);
    XFlush(source.display);
}

/// Gives the list of files to whoever asks.
void give(const Source& source, const XSelectionRequestEvent& asked) {
    XChangeProperty(source.display, asked.requestor, asked.property, asked.target, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(source.uris.data()),
                    static_cast<int>(source.uris.size()));
    XEvent answer{};
    answer.xselection.type = SelectionNotify;
    answer.xselection.requestor = asked.requestor;
    answer.xselection.selection = asked.selection;
    answer.xselection.target = asked.target;
    answer.xselection.property = asked.property;
    answer.xselection.time = asked.time;
    XSendEvent(source.display, asked.requestor, False, NoEventMask, &answer);
    XFlush(source.display);
}

/// Serves the target until it sends a message of this kind; false where none comes within two
/// minutes.
bool wait_for(const Source& source, const char* kind) {
    using namespace std::chrono_literals;
    const auto end = std::chrono::steady_clock::now() + 120s; // clock: gives up after 2 min
    while (std::chrono::steady_clock::now() < end) {          // clock: as above
        if (XPending(source.display) == 0) {
            std::this_thread::sleep_for(5ms); // clock: polls
            continue;
        }
        XEvent event;
        XNextEvent(source.display, &event);
        if (event.type == SelectionRequest) give(source, event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == source.atom(kind))
            return true;
    }
    std::fprintf(stderr, "drop_files: the window sends no %s\n", kind);
    return false;
}

} // namespace

int main(int count, char** words) {
    Source source;
    source.display = XOpenDisplay(nullptr);
    if (count < 5 || !source.display) return 2;
    source.target = std::strtoul(words[1], nullptr, 0);
    const long block_state = std::atol(words[2]) << 16 | std::atol(words[3]);
    for (int i = 4; i < count; ++i) source.uris += "file://" + std::string(words[i]) + "\r\n";
    source.own =
        XCreateSimpleWindow(source.display, DefaultRootWindow(source.display), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(source.display, source.atom("XdndSelection"), source.own, CurrentTime);
    constexpr long version = 5;
    send(source, "XdndEnter", version << 24, static_cast<long>(source.atom("text/uri-list")), 0, 0);
    send(source, "XdndPosition", 0, block_state, CurrentTime,
         static_cast<long>(source.atom("XdndActionCopy")));
    if (!wait_for(source, "XdndStatus")) return 1;
    send(source, "XdndDrop", 0, CurrentTime, 0, 0);
    const bool is_taken = wait_for(source, "XdndFinished");
    XCloseDisplay(source.display);
    return is_taken ? 0 : 1;
}
