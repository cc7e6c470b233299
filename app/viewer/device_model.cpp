#include "app/viewer/device_model.h"

#include <algorithm>
#include <utility>

#include "app/viewer/navigation.h"

namespace app::viewer {
namespace {

/// A device runs what the files say; a program that goes another way than they do is not asked.
bool can_run(const ViewModel& model) {
    return model.program && !model.failure && model.changes.empty();
}

/// Of which program answers are wanted; 0: of none.
uint64_t wanted_opening(const ViewModel& model) {
    const DeviceModel& device = model.device;
    if (!can_run(model)) return 0;
    if (device.shown) return model.opening;
    return device.study && device.opening == model.opening ? model.opening : 0;
}

void forget_run(DeviceModel& device) {
    device = {.file = std::move(device.file), .shown = device.shown};
}

} // namespace

void show_device(ViewModel& model, bool shown) { model.device.shown = shown; }

void switch_off_device(ViewModel& model) {
    model.device.shown = false;
    model.device.study = nullptr;
}

void take_in(ViewModel& model, DeviceUpdate news) {
    DeviceModel& device = model.device;
    if (!news.has_news || news.run != device.run || device.run == 0) return;
    device.share = news.share;
    device.blocks = news.blocks;
    device.is_fitting = news.is_fitting;
    device.is_running = !news.is_done;
    if (news.study) device.study = std::move(news.study);
    if (news.failure) device.failure = std::move(news.failure);
}

bool send_device_orders(ViewModel& model, DeviceWorker& worker,
                        const std::optional<CheckJob>& check) {
    DeviceModel& device = model.device;
    const uint64_t wanted = check ? wanted_opening(model) : 0;
    if (wanted == device.opening) return false;
    forget_run(device);
    device.opening = wanted;
    if (wanted == 0) {
        worker.stop();
        return true;
    }
    device.run = worker.start({*check, device.file});
    device.is_running = true;
    return true;
}

bool go_to_stop(ViewModel& model, bool forward) {
    if (!model.device.study || !model.has_rows()) return false;
    const std::vector<size_t>& all = model.device.study->stops;
    if (all.empty()) return false;
    const size_t here = model.cursor.block;
    model.playback.running = false;
    const auto above = std::upper_bound(all.begin(), all.end(), here);
    const auto below = std::lower_bound(all.begin(), all.end(), here);
    if (forward)
        go_to(model, above == all.end() ? all.front() : *above);
    else
        go_to(model, below == all.begin() ? all.back() : *(below - 1));
    return true;
}

} // namespace app::viewer
