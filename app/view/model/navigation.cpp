#include "app/view/model/navigation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "app/base/text.h"
#include "app/view/model/axis_display.h"
#include "app/view/model/placing.h"
#include "app/view/model/view_model.h"
#include "gcode/text/program_text.h"

namespace app::viewer {
namespace {

/// The factor for slow motion near obstacles: a fifth of the speed where the clearance is less than
/// twice the allowance.
double slowing(const ViewModel& model) {
    if (!model.playback.slow_near) return 1.0;
    const BlockRow& row = model.row();
    return is_offending(row) || is_near(row) ? 0.2 : 1.0;
}

size_t rank_of(const std::vector<size_t>& filtered, size_t block) {
    return static_cast<size_t>(std::lower_bound(filtered.begin(), filtered.end(), block)
                               - filtered.begin());
}

size_t stepped(const ViewModel& model, int blocks) {
    const auto moved = [blocks](size_t from, size_t count) {
        const auto to = static_cast<long long>(from) + blocks;
        return static_cast<size_t>(std::clamp<long long>(to, 0, static_cast<long long>(count) - 1));
    };
    if (model.filtered.empty()) return moved(model.cursor.block, model.rows.size());
    const size_t rank = rank_of(model.filtered, model.cursor.block);
    const bool is_between =
        rank == model.filtered.size() || model.filtered[rank] != model.cursor.block;
    const int by = is_between && blocks > 0 ? blocks - 1 : blocks;
    const auto to = std::clamp<long long>(static_cast<long long>(rank) + by, 0,
                                          static_cast<long long>(model.filtered.size()) - 1);
    return model.filtered[static_cast<size_t>(to)];
}

} // namespace

void go_to(ViewModel& model, size_t block, double fraction) {
    if (!model.has_rows()) return;
    stay(model);
    end_jog(model);
    model.cursor = {std::min(block, model.rows.size() - 1), std::clamp(fraction, 0.0, 1.0)};
    model.shown_pair = {};
    model.wanted = ShowRequest{model.cursor.block, model.cursor.fraction >= 1.0};
    model.list_follows = true;
    model.range = showing(model.range, model.rows.size(), model.cursor.block);
}

void go_to_witness(ViewModel& model, size_t block, const BodyNames& names) {
    if (!model.has_rows()) return;
    const BlockRow& row = model.rows[std::min(block, model.rows.size() - 1)];
    const auto witness = witness_in(row, names);
    const bool known = witness && row.duration > 0.0;
    const BodyNames shown = names; // may be that of the model
    go_to(model, block, known ? std::min(witness->time / row.duration, 0.9999) : 1.0);
    model.shown_pair = shown;
}

void step(ViewModel& model, int blocks) {
    if (!model.has_rows()) return;
    model.playback.running = false;
    // In the middle of a block, the first step goes to its end.
    if (blocks > 0 && model.cursor.fraction < 1.0) --blocks;
    go_to(model, stepped(model, blocks));
}

void step_tool(ViewModel& model, bool forward) {
    if (!model.has_rows()) return;
    const size_t here = model.cursor.block;
    if (forward) {
        for (const ToolBand& band : model.bands)
            if (band.first > here) return go_to(model, band.first);
        return go_to(model, model.rows.size() - 1);
    }
    for (auto band = model.bands.rbegin(); band != model.bands.rend(); ++band)
        if (band->first < here) return go_to(model, band->first);
    go_to(model, 0);
}

void step_over(ViewModel& model, bool forward) {
    if (!model.has_rows()) return;
    const uint32_t depth = model.row().depth;
    size_t block = model.cursor.block;
    do {
        if (forward ? block + 1 >= model.rows.size() : block == 0) break;
        block = forward ? block + 1 : block - 1;
    } while (model.rows[block].depth > depth);
    go_to(model, block);
}

void step_out(ViewModel& model) {
    if (!model.has_rows()) return;
    const uint32_t depth = model.row().depth;
    if (depth == 0) return;
    size_t block = model.cursor.block;
    while (block + 1 < model.rows.size() && model.rows[block].depth >= depth) ++block;
    go_to(model, block);
}

bool go_to_offending(ViewModel& model, bool forward) {
    if (!model.has_rows()) return false;
    const std::vector<size_t>& all = model.offending;
    const size_t here = model.cursor.block;
    const auto above = std::upper_bound(all.begin(), all.end(), here);
    const auto below = std::lower_bound(all.begin(), all.end(), here);
    model.playback.running = false;
    if (forward && above != all.end()) return go_to_witness(model, *above), true;
    if (!forward && below != all.begin()) return go_to_witness(model, *(below - 1)), true;
    if (forward && !model.is_recorded) {
        model.awaits_offending = true;
        return true;
    }
    if (all.empty()) return false;
    go_to_witness(model, forward ? all.front() : all.back());
    return true;
}

bool await_offending(ViewModel& model) {
    if (!model.awaits_offending) return true;
    const auto above =
        std::upper_bound(model.offending.begin(), model.offending.end(), model.cursor.block);
    if (above != model.offending.end()) return go_to_witness(model, *above), true;
    if (!model.is_recorded) return true;
    model.awaits_offending = false;
    return go_to_offending(model, true);
}

void go_to_bookmark(ViewModel& model) {
    if (model.bookmarks.empty()) return;
    const auto next = model.bookmarks.upper_bound(model.cursor.block);
    go_to(model, next == model.bookmarks.end() ? *model.bookmarks.begin() : *next);
}

void go_to_stretch(ViewModel& model, const StretchIndex& which) {
    model.playback.running = false;
    model.selected = which;
    const FindingGroup& group = model.groups[which.group];
    go_to_witness(model, group.stretches[which.stretch].worst, group.pair);
}

bool step_stretch(ViewModel& model, bool forward) {
    const auto next = neighbouring_stretch(model.groups, selected_stretch(model), forward);
    if (next) go_to_stretch(model, *next);
    return next.has_value();
}

std::optional<StretchIndex> selected_stretch(const ViewModel& model) {
    const size_t block = model.cursor.block;
    if (model.selected && model.selected->group < model.groups.size()) {
        const auto& stretches = model.groups[model.selected->group].stretches;
        const size_t index = model.selected->stretch;
        if (index < stretches.size() && stretches[index].first <= block
            && block <= stretches[index].last)
            return model.selected;
    }
    return stretch_at(model.groups, block);
}

void show_findings(ViewModel& model, bool shown) {
    model.shows_findings = shown;
    show_setup(model, false);
}

void show_setup(ViewModel& model, bool shown) {
    model.shows_setup = shown;
    begin_picking(model, PickGoal::none);
    model.workspace.wants_focus = shown;
    model.workspace.has_keys = false;
    model.list_follows = true;
}

std::string notes_key(const ViewModel& model) {
    if (!model.program) return {};
    return utf8_text(absolute_path(model.program->program));
}

std::string note_at(const ViewModel& model, const StretchIndex& which) {
    if (!model.program) return {};
    const FindingGroup& group = model.groups[which.group];
    return note_on(model.notes, notes_key(model), group,
                   model.rows[group.stretches[which.stretch].first]);
}

void write_note_at(ViewModel& model, const StretchIndex& which, const std::string& text) {
    if (!model.program) return;
    const FindingGroup& group = model.groups[which.group];
    write_note(model.notes, notes_key(model), group,
               model.rows[group.stretches[which.stretch].first], text);
    model.notes_changed = true;
}

size_t worst_block(const ViewModel& model) {
    size_t worst = 0;
    const auto margin = [](const BlockRow& row) {
        const bool says_little = is_contact(row) && *row.lower <= core::resolution;
        return row.has_pair() && !says_little ? *row.lower - *row.allowance
                                              : std::numeric_limits<double>::max();
    };
    const auto is_worse = [&](const BlockRow& a, const BlockRow& b) {
        if (a.verdict != b.verdict) return a.verdict > b.verdict;
        const bool a_fails = a.worst == core::Severity::error;
        const bool b_fails = b.worst == core::Severity::error;
        if (a_fails != b_fails) return a_fails;
        return margin(a) < margin(b);
    };
    for (size_t i = 1; i < model.rows.size(); ++i)
        if (is_worse(model.rows[i], model.rows[worst])) worst = i;
    return worst;
}

std::optional<size_t> find_line(const ViewModel& model, const std::string& text) {
    if (text.empty() || !model.has_rows()) return {};
    const bool has_letter = text[0] == 'N' || text[0] == 'n';
    const bool counts_blocks = model.program && model.program->counts_blocks;
    const auto number = gcode::number_in(std::string_view(text).substr(has_letter ? 1 : 0));
    if (!number) return {};
    const auto fits = [&](const BlockRow& row) {
        if (!has_letter && !counts_blocks) return row.file.empty() && row.line == *number;
        return gcode::block_number(row.text, !counts_blocks) == number;
    };
    const size_t count = model.rows.size();
    for (size_t i = 0; i < count; ++i) {
        const size_t block = (model.cursor.block + i) % count;
        if (fits(model.rows[block])) return block;
    }
    return {};
}

bool has_breakpoint(const ViewModel& model, const BlockRow& row) {
    return std::any_of(model.breakpoints.begin(), model.breakpoints.end(), [&](const auto& b) {
        return b.line && *b.line == row.line && b.file == row.file;
    });
}

void toggle_breakpoint(ViewModel& model, size_t block) {
    if (block >= model.rows.size()) return;
    const BlockRow& row = model.rows[block];
    std::vector<Breakpoint>& all = model.breakpoints;
    model.breakpoints_changed = true;
    const size_t before = all.size();
    std::erase_if(
        all, [&](const auto& b) { return b.line && *b.line == row.line && b.file == row.file; });
    if (all.size() != before) return;
    Breakpoint breakpoint;
    breakpoint.line = row.line;
    breakpoint.file = row.file;
    all.push_back(std::move(breakpoint));
}

bool play(ViewModel& model, double seconds) {
    if (!model.playback.running || !model.has_rows()) return false;
    double left = seconds * model.playback.speed * slowing(model);
    size_t block = model.cursor.block;
    double fraction = model.cursor.fraction;
    while (left > 0.0) {
        const double duration = model.rows[block].duration;
        const double rest = std::max(duration * (1.0 - fraction), 0.0);
        if (rest > left) {
            fraction += left / duration;
            break;
        }
        left -= rest;
        fraction = 1.0;
        if (block + 1 == model.rows.size()) {
            model.playback.running = false;
            break;
        }
        ++block;
        fraction = 0.0;
    }
    const bool is_same_stock =
        block == model.cursor.block && fraction < 1.0 && model.cursor.fraction < 1.0;
    if (block != model.cursor.block) model.shown_pair = {};
    end_jog(model);
    model.cursor = {block, fraction};
    if (!is_same_stock) model.wanted = ShowRequest{block, fraction >= 1.0};
    model.list_follows = true;
    model.range = showing(model.range, model.rows.size(), block);
    return true;
}

double next_speed(double speed, bool faster) {
    constexpr double speeds[] = {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
    if (faster) {
        for (const double next : speeds)
            if (next > speed * 1.001) return next;
        return fastest;
    }
    for (size_t i = std::size(speeds); i-- > 0;)
        if (speeds[i] < speed * 0.999) return speeds[i];
    return slowest;
}

} // namespace app::viewer
