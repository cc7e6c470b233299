#include "app/viewer/device_study.h"

#include <cmath>

namespace app::viewer {
namespace {

/// Set points between permit and need below which slack is little.
constexpr double near_periods = 10.0;

TimelineCell slack_cell(const DeviceStudy& study, size_t block) {
    const DeviceAnswer answer = answer_of(&study, block);
    const auto slack = slack_of(&study, block);
    TimelineCell cell;
    cell.known = answer != DeviceAnswer::unknown;
    cell.offending = stops_machine(answer);
    cell.moves = slack.has_value() || cell.offending;
    if (slack) cell.least = *slack;
    cell.near = slack && *slack < study.near;
    return cell;
}

} // namespace

std::shared_ptr<const DeviceStudy> study_of(CoprocessorResult result) {
    auto study = std::make_shared<DeviceStudy>();
    study->figures = figures(result);
    study->agreement = agreement(result.run);
    study->near = near_periods * result.file.control.servo.period;
    study->result = std::move(result);
    study->result.run.check.stock.reset(); // nobody looks at it
    study->slack.resize(study->size());
    for (size_t i = 0; i < study->size(); ++i) {
        const TimelineCell cell = slack_cell(*study, i);
        study->slack.set(i, cell);
        if (cell.offending) study->stops.push_back(i);
        if (!study->held && !study->result.run.blocks[i].permit.permitted) study->held = i;
    }
    return study;
}

DeviceAnswer answer_of(const DeviceStudy* study, size_t block) {
    if (!study || block >= study->size()) return DeviceAnswer::unknown;
    const BlockPermit& permit = study->result.run.blocks[block].permit;
    if (!permit.not_asked.empty()) return DeviceAnswer::not_asked;
    if (!permit.permitted) return DeviceAnswer::refused;
    if (study->result.timing.blocks[block].is_late()) return DeviceAnswer::late;
    return permit.segments == 0 ? DeviceAnswer::nothing : DeviceAnswer::permitted;
}

bool stops_machine(DeviceAnswer answer) {
    return answer == DeviceAnswer::late || answer == DeviceAnswer::refused
           || answer == DeviceAnswer::not_asked;
}

std::optional<double> slack_of(const DeviceStudy* study, size_t block) {
    if (!study || block >= study->size()) return {};
    const double slack = study->result.timing.blocks[block].slack();
    if (!std::isfinite(slack)) return {};
    return slack;
}

} // namespace app::viewer
