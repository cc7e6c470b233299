#include "app/viewer/window_title.h"

#include <filesystem>

#include <fmt/format.h>

namespace app::viewer {
namespace {

const char* words_of(DeviceAnswer answer) {
    switch (answer) {
    case DeviceAnswer::unknown:
        return "no answer";
    case DeviceAnswer::nothing:
        return "nothing to ask";
    case DeviceAnswer::permitted:
        return "permitted";
    case DeviceAnswer::late:
        return "late";
    case DeviceAnswer::refused:
        return "refused";
    case DeviceAnswer::not_asked:
        return "not asked";
    }
    return "";
}

std::string device_words(const ViewModel& model) {
    const DeviceModel& device = model.device;
    if (!device.shown) return {};
    if (device.failure) return ", coprocessor: failed";
    if (!device.study) return device.is_running ? ", coprocessor: running" : ", coprocessor";
    return std::string(", coprocessor: ")
           + words_of(answer_of(device.study.get(), model.cursor.block));
}

} // namespace

std::string window_title(const ViewModel& model) {
    if (model.failure || (model.is_recorded && !model.has_rows()))
        return "This could not be opened - feeler";
    if (!model.program) return "feeler";
    std::string title = std::filesystem::path(model.program->program).filename().string();
    if (model.has_rows())
        title += fmt::format(", line {} (block {} of {}{})", model.row().line, model.cursor.block,
                             model.rows.size() - 1, is_offending(model.row()) ? ", violation" : "");
    title += device_words(model);
    if (!model.missing.empty()) title += ", gone or empty";
    if (model.stopped) title += fmt::format(", stopped at line {}", model.stopped->where.line);
    return title + " - feeler";
}

} // namespace app::viewer
