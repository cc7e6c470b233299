#include "app/viewer/frame_log.h"

#include <chrono>

#include <fmt/format.h>

namespace app::viewer {
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
    const long shown = model.place ? static_cast<long>(model.place->block) : -1L;
    const size_t points = model.path ? model.path->points.size() : 0;
    file_ << fmt::format("frame {:.4f} {:.4f} {} {} {}\n", begin_, now(), model.cursor.block, shown,
                         points)
          << std::flush;
}

} // namespace app::viewer
