#include "app/viewer/key_queue.h"

#include <set>

#include <imgui.h>

#include "app/viewer/key_codes.h"

namespace app::viewer {

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

} // namespace app::viewer
