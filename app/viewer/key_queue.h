#pragma once

#include <deque>
#include <utility>

struct ImGuiIO;

namespace app::viewer {

/// Keys on their way to ImGui 1.86, which knows of each only whether it is down in a frame.
///
/// One that is pressed and released between two frames gets a frame for each; a modifier that goes
/// up behind a key is down as long as that one is new.
class KeyQueue {
public:
    /// A key by its code in GLFW.
    void add(int code, bool is_down);

    /// Tells ImGui what it can be told for the next frame; whether something is left for a later
    /// one.
    bool feed(ImGuiIO& io);

private:
    std::deque<std::pair<int, bool>> keys_;
};

} // namespace app::viewer
