#include "app/view/model/open_programs.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/view/model/view_model.h"

namespace app::viewer {
namespace {

namespace fs = std::filesystem;

render::ClearanceState state_of_program(const ViewModel& model) {
    using render::ClearanceState;
    const bool runs_nothing = model.is_recorded && !model.has_rows();
    if (model.failure || runs_nothing || model.stopped || !model.offending.empty())
        return ClearanceState::violation;
    return model.is_recorded && is_current(model) ? ClearanceState::clear : ClearanceState::none;
}

TabTitle title_of(const ViewModel& model) {
    TabTitle title;
    title.path = model.opened_path;
    title.name = title.path.empty() ? "Start" : fs::path(title.path).filename().generic_string();
    title.state = state_of_program(model);
    title.is_modified = model.workspace.document.is_modified();
    return title;
}

} // namespace

std::vector<TabTitle> tab_titles(const std::vector<const ViewModel*>& programs) {
    std::vector<TabTitle> titles;
    titles.reserve(programs.size());
    for (const ViewModel* program : programs) titles.push_back(title_of(*program));
    std::vector<std::string> names;
    names.reserve(titles.size());
    for (const TabTitle& title : titles) names.push_back(title.name);
    for (TabTitle& title : titles) {
        if (std::count(names.begin(), names.end(), title.name) < 2) continue;
        const std::string folder = fs::path(title.path).parent_path().filename().generic_string();
        if (!folder.empty()) title.name = folder + "/" + title.name;
    }
    return titles;
}

void show_in_place(ViewModel& to, ViewModel& from) {
    to.settings = from.settings;
    if (!to.settings.has_own_unit && to.program) to.settings.inch = to.program->is_inch;
    to.notes = from.notes;
    to.browser = from.browser;
    to.recent = from.recent;
    to.samples = from.samples;
    to.list_follows = true;
    if (from.popup == Popup::open_file) to.popup = Popup::open_file;
    from.popup = Popup::none;
    from.workspace.leaving = Leaving::no;
    from.playback.running = false;
}

} // namespace app::viewer
